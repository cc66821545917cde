// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// The OpenVDB grids this library takes and returns: the standard 5-4-3 trees. Included instead of
// <openvdb/openvdb.h>, which costs three times as much to compile.

#include <openvdb/Grid.h>
#include <openvdb/tree/Tree.h>

#include <cstdint>

#include "vdb_madf/base/interrupter.h"

namespace vdb_madf {

template <typename T>
using StandardTree = typename openvdb::tree::Tree4<T, 5, 4, 3>::Type;

using MaskTree = StandardTree<openvdb::ValueMask>;
using Int32Tree = StandardTree<int32_t>;
using MaskGrid = openvdb::Grid<MaskTree>;              ///< = openvdb::MaskGrid
using BoolGrid = openvdb::Grid<StandardTree<bool>>;    ///< = openvdb::BoolGrid
using Int32Grid = openvdb::Grid<Int32Tree>;            ///< = openvdb::Int32Grid
using FloatGrid = openvdb::Grid<StandardTree<float>>;  ///< = openvdb::FloatGrid

using openvdb::Coord;
using openvdb::CoordBBox;

}  // namespace vdb_madf
