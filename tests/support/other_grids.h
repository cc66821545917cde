// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/detail/grid_instances.h"

/// Grids that the library reads and writes, or refuses, but never computes with.
namespace vdb_madf::test {

using DoubleGrid = openvdb::Grid<StandardTree<double>>;
using Int64Grid = openvdb::Grid<StandardTree<int64_t>>;
using UInt32Grid = openvdb::Grid<StandardTree<uint32_t>>;
using Vec3sGrid = openvdb::Grid<StandardTree<openvdb::Vec3s>>;

}  // namespace vdb_madf::test

// Compiled once, in other_grids.cc, as those of grid_instances.h are.
extern template class openvdb::Grid<vdb_madf::StandardTree<double>>;
extern template class openvdb::Grid<vdb_madf::StandardTree<int64_t>>;
extern template class openvdb::Grid<vdb_madf::StandardTree<uint32_t>>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<double>::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<int64_t>::RootNodeType>;
extern template class openvdb::tree::Tree<vdb_madf::StandardTree<uint32_t>::RootNodeType>;
