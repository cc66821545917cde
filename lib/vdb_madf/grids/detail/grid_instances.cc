// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/detail/grid_instances.h"

#ifdef VDB_MADF_OPENVDB_HAS_GRIDS

// OpenVDB's own library has their virtual interface, as it registers them by name. Here is what it never
// calls itself.
template vdb_madf::MaskGrid::Ptr openvdb::Grid<vdb_madf::MaskTree>::create(vdb_madf::MaskTree::Ptr);
template vdb_madf::Int32Grid::Ptr openvdb::Grid<vdb_madf::Int32Tree>::create(
    vdb_madf::Int32Tree::Ptr);
template vdb_madf::BoolGrid::Ptr vdb_madf::BoolGrid::create(vdb_madf::BoolGrid::TreePtrType);
template vdb_madf::FloatGrid::Ptr vdb_madf::FloatGrid::create(vdb_madf::FloatGrid::TreePtrType);

#else

template class openvdb::Grid<vdb_madf::MaskTree>;
template class openvdb::Grid<vdb_madf::Int32Tree>;
template class openvdb::Grid<vdb_madf::StandardTree<bool>>;
template class openvdb::Grid<vdb_madf::StandardTree<float>>;
template class openvdb::tree::Tree<vdb_madf::MaskTree::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::Int32Tree::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<bool>::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<float>::RootNodeType>;

#endif
