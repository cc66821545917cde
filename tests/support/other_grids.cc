// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "support/other_grids.h"

template class openvdb::Grid<vdb_madf::StandardTree<double>>;
template class openvdb::Grid<vdb_madf::StandardTree<int64_t>>;
template class openvdb::Grid<vdb_madf::StandardTree<uint32_t>>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<double>::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<int64_t>::RootNodeType>;
template class openvdb::tree::Tree<vdb_madf::StandardTree<uint32_t>::RootNodeType>;
