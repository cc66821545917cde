// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/method/critical_point.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf::detail {

/// Where the flow of a slab's voxels ends, as far as the slab can tell. A path ends at a critical
/// point of the slab, or leaves it at the first ball of another slab that it meets: its terminal.
/// Terminals stand for critical points until all slabs are known: D rises along every path, so what
/// has one terminal has one critical point.
struct SlabTerminals {
  /// A voxel of the lowest or highest layer.
  struct FaceVoxel {
    int32_t x, y;
    uint32_t terminal;  ///< as in Flow::manifold
    int32_t power;
  };

  /// Lexicographic; those outside of the slab are balls of others, D = 0. `voxels`: of the object.
  std::vector<CriticalPoint> points;
  std::vector<ManifoldGraph::Edge> edges;  ///< between points; adjacent voxels of the slab
  int64_t balls = 0;  ///< medial balls that are voxels of the slab, as it knows
  /// The voxels beside the cuts, by leaf column, then x, y; not written.
  std::vector<FaceVoxel> lowest, highest;

  /// The pairs of adjacent voxels on either side of a cut, as edges from a point of the slab below
  /// to one of that above (first and second are numbers of different lists).
  static std::vector<ManifoldGraph::Edge> contacts(const std::vector<FaceVoxel>& below,
                                                   const std::vector<FaceVoxel>& above);

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.points, self.edges, self.balls);
  }
};

/// @param cavities voxels that are none of the object, ascending
SlabTerminals slabTerminals(const LeafIndex& index, const Flow& flow,
                            const VoxelArray<int32_t>& power, const VoxelSet& balls,
                            const std::vector<VoxelId>& cavities, int begin, int end,
                            Interrupter* interrupter);

}  // namespace vdb_madf::detail
