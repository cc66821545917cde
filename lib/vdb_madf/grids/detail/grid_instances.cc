// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/detail/grid_instances.h"

template class openvdb::Grid<vdb_madf::MaskTree>;
template class openvdb::Grid<vdb_madf::Int32Tree>;
template class openvdb::Grid<vdb_madf::StandardTree<bool>>;
template class openvdb::Grid<vdb_madf::StandardTree<float>>;
template class openvdb::Grid<vdb_madf::StandardTree<openvdb::Vec3f>>;
template class openvdb::tree::Tree<vdb_madf::MaskTree::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::Int32Tree::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<bool>::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<float>::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<openvdb::Vec3f>::RootNodeType>;
