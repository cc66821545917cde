// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/detail/grid_instances.h"

#ifdef VDB_MADF_OPENVDB_HAS_GRIDS

// OpenVDB's own library has their virtual interface, as it registers them by name. Here is what it never
// calls itself.
template vdb_madf::MaskGrid::Ptr openvdb::Grid<vdb_madf::MaskGrid::TreeType>::create(
    vdb_madf::MaskGrid::TreePtrType);
template vdb_madf::MaskGrid::Ptr openvdb::Grid<vdb_madf::MaskGrid::TreeType>::create(
    const vdb_madf::MaskGrid::ValueType&);
template vdb_madf::MaskGrid::Ptr openvdb::Grid<vdb_madf::MaskGrid::TreeType>::deepCopy() const;
template vdb_madf::Int32Grid::Ptr openvdb::Grid<vdb_madf::Int32Grid::TreeType>::create(
    vdb_madf::Int32Grid::TreePtrType);
template vdb_madf::Int32Grid::Ptr openvdb::Grid<vdb_madf::Int32Grid::TreeType>::create(
    const vdb_madf::Int32Grid::ValueType&);
template vdb_madf::Int32Grid::Ptr openvdb::Grid<vdb_madf::Int32Grid::TreeType>::deepCopy() const;
template vdb_madf::BoolGrid::Ptr openvdb::Grid<vdb_madf::BoolGrid::TreeType>::create(
    vdb_madf::BoolGrid::TreePtrType);
template vdb_madf::BoolGrid::Ptr openvdb::Grid<vdb_madf::BoolGrid::TreeType>::create(
    const vdb_madf::BoolGrid::ValueType&);
template vdb_madf::BoolGrid::Ptr openvdb::Grid<vdb_madf::BoolGrid::TreeType>::deepCopy() const;
template vdb_madf::FloatGrid::Ptr openvdb::Grid<vdb_madf::FloatGrid::TreeType>::create(
    vdb_madf::FloatGrid::TreePtrType);
template vdb_madf::FloatGrid::Ptr openvdb::Grid<vdb_madf::FloatGrid::TreeType>::create(
    const vdb_madf::FloatGrid::ValueType&);
template vdb_madf::FloatGrid::Ptr openvdb::Grid<vdb_madf::FloatGrid::TreeType>::deepCopy() const;

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
