// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/TypeList.h>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The grids that hold one number a voxel, and what messages call them.
using NumberGrids =
    openvdb::TypeList<BoolGrid, MaskGrid, Int32Grid, openvdb::Grid<StandardTree<int64_t>>,
                      FloatGrid, openvdb::Grid<StandardTree<double>>>;
inline constexpr char kNumberGrids[] = "bool, mask, int32, int64, float and double";

}  // namespace vdb_madf::detail
