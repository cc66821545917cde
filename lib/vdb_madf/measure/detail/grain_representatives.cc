// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/grain_representatives.h"

#include <algorithm>
#include <unordered_map>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/boundary.h"

namespace vdb_madf::detail {

namespace {

/// Takes over what is deeper; leaves may come in any order.
void improve(const GrainRepresentative& candidate, GrainRepresentative& best) {
  if (candidate.squaredRadius > best.squaredRadius ||
      (candidate.squaredRadius == best.squaredRadius && candidate.voxel < best.voxel))
    best = candidate;
}

VDB_MADF_SIMD int32_t largest(const int32_t* values, size_t count) {
  int32_t most = 0;
  for (size_t i = 0; i < count; ++i) most = std::max(most, values[i]);
  return most;
}

GrainRepresentative deepestOf(const LabelPart& part, const LeafIndex& index, size_t leaf,
                              const VoxelArray<int32_t>& distances) {
  GrainRepresentative deepest;
  for (size_t x = 0; x < 8; ++x)
    forEachBit(part.mask[x], [&](int bit) {
      const auto id = VoxelId(leaf * 512 + x * 64 + size_t(bit));
      const int32_t d = distances[index.rank(id)];
      // Voxels come in the order that decides ties.
      if (d > deepest.squaredRadius) deepest = {index.coord(id), d};
    });
  return deepest;
}

}  // namespace

GrainRepresentatives grainRepresentatives(const LabelLeaves& labels, const Obstacles& obstacles,
                                          const VoxelWeights& weights, Interrupter* interrupter) {
  GrainRepresentatives result;
  const LeafIndex& index = labels.index();
  if (index.leafCount() == 0) return result;
  if (obstacles.open && index.voxelCount() == obstacles.domain.voxelCount()) return result;
  const VoxelArray<int32_t> distances =
      squaredDistance(index, obstacles, weights, interrupter).values;
  using Best = std::unordered_map<int32_t, GrainRepresentative>;
  PerThread<Best> bests;
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    Best& best = bests.local();
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const LabelLeaves::Parts parts = labels.parts(leaf);
      const int32_t* d = distances.data() + index.firstRank(leaf);
      for (const LabelPart& part : parts) {
        GrainRepresentative& known = best[part.label];
        // Most leaves hold nothing deeper than what is known.
        if (parts.size() == 1 && largest(d, index.leafVoxels(leaf)) < known.squaredRadius) continue;
        improve(deepestOf(part, index, leaf, distances), known);
      }
    }
  });
  for (const Best& best : bests)
    for (const auto& [label, representative] : best) improve(representative, result[label]);
  return result;
}

GrainRepresentatives grainRepresentatives(const Int32Grid& labels, const ManifoldGraph& graph) {
  GrainRepresentatives result;
  const auto accessor = labels.getConstAccessor();
  for (const ManifoldGraph::Node& node : graph.nodes)
    improve({node.position, node.squaredRadius}, result[accessor.getValue(node.position)]);
  return result;
}

}  // namespace vdb_madf::detail
