// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/method/detail/swept_leaves.h"

namespace vdb_madf::detail {

/// What the sweeps of a power map go through: a power, or a number for it, and a site for each
/// voxel. Unknown voxels are uncovered.
struct PowerValues {
  SweptValues<int32_t> power;
  SweptValues<VoxelId> site;
};

/// The number of the pass along an axis: passes go along z, y, x.
constexpr int powerPass(int axis) {
  return 2 - axis;
}

}  // namespace vdb_madf::detail
