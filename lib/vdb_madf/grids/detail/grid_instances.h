// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

// The grids of grid_types.h, compiled once, in grid_instances.cc. Without this every file that
// makes or copies a grid would compile the grid's and the tree's whole virtual interface again.
// Part of the precompiled header of our sources; programs that use the library do not see it.

extern template class openvdb::Grid<vdb_madf::MaskTree>;
extern template class openvdb::Grid<vdb_madf::Int32Tree>;
extern template class openvdb::Grid<vdb_madf::StandardTree<bool>>;
extern template class openvdb::Grid<vdb_madf::StandardTree<float>>;
extern template class openvdb::Grid<vdb_madf::StandardTree<openvdb::Vec3f>>;
extern template class openvdb::tree::Tree<vdb_madf::MaskTree::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::Int32Tree::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<bool>::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<float>::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<openvdb::Vec3f>::RootNodeType>;
