// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/leaves/voxel_set.h"
#include "vdb_madf/method/critical_point.h"

namespace vdb_madf {

/// Where every voxel flows (paper, Def. 6 and 7).
struct Flow {
  /// Set in `manifold` at the voxels of the critical points' own cells: Pi(p) is critical.
  static constexpr uint32_t kOwnCell = 1u << 31;
  /// 1 + the index in criticalPoints of the critical point that a voxel flows to, and kOwnCell.
  VoxelArray<uint32_t> manifold;
  /// Fixed points of Pi with D and the size of their stable manifolds, lexicographic by position.
  std::vector<CriticalPoint> criticalPoints;
};

/// Follows p -> Pi(p) -> Pi(Pi(p)) ... to the fixed points, by pointer jumping on the balls: a set
/// that holds all sites. The site array becomes that of the manifolds. The flow climbs in D, so
/// there are no cycles. Sites in foreign leaves (leaf_index.h) count as fixed points, with D = 0.
/// @throw Interrupted
Flow flow(const LeafIndex& index, VoxelArray<VoxelId> site, const VoxelArray<int32_t>& power,
          const VoxelSet& balls, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
