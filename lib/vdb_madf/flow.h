// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/manifold_graph.h"
#include "vdb_madf/medial_balls.h"
#include "vdb_madf/power_map.h"

namespace vdb_madf {

/// Where every voxel flows (paper, Def. 6 and 7).
struct Flow {
  /// 1 + the index in criticalPoints of the critical point that a voxel flows to; 0 outside X.
  VoxelArray<uint32_t> manifold;
  /// Voxels of the critical points' own cells: Pi(p) is critical.
  VoxelSet direct;
  /// Fixed points of Pi with D and the size of their stable manifolds, lexicographic by position.
  std::vector<ManifoldGraph::Node> criticalPoints;
};

/// Follows p -> Pi(p) -> Pi(Pi(p)) ... to the fixed points, by pointer jumping in the site array,
/// which is consumed. The flow climbs in D, so there are no cycles.
/// @throw Interrupted
Flow flow(const LeafIndex& index, VoxelArray<VoxelId> site, const VoxelArray<int32_t>& power,
          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
