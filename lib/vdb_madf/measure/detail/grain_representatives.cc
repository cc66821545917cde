// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/grain_representatives.h"

#include <algorithm>
#include <atomic>
#include <limits>
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

VDB_MADF_KERNEL int32_t largestKernel(const int32_t* values, size_t count) {
  int32_t most = 0;
  for (size_t i = 0; i < count; ++i) most = std::max(most, values[i]);
  return most;
}

int32_t largest(const int32_t* values, size_t count) {
  return atBestLevel([&]() VDB_MADF_INLINE { return largestKernel(values, count); });
}

GrainRepresentative deepestOf(const LabelPart& part, const LeafIndex& index, size_t leaf,
                              const VoxelArray<int32_t>& distances) {
  GrainRepresentative deepest;
  for (size_t x = 0; x < 8; ++x)
    forEachBit(part.mask[x], [&](int bit) {
      const auto id = voxelId(leaf, x, size_t(bit));
      const int32_t d = distances[index.rank(id)];
      // Voxels come in the order that decides ties.
      if (d > deepest.squaredRadius) deepest = {index.coord(id), d};
    });
  return deepest;
}

/// The deepest voxels in some layers of leaves.
GrainRepresentatives deepest(const LabelLeaves& labels, const LeafLayers& layers,
                             const VoxelArray<int32_t>& distances, Interrupter* interrupter) {
  GrainRepresentatives result;
  const LeafIndex& index = labels.index();
  using Best = std::unordered_map<int32_t, GrainRepresentative>;
  PerThread<Best> bests;
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    Best& best = bests.local();
    for (size_t leaf = begin; leaf < end; ++leaf) {
      if (!layers.hold(index.origin(leaf))) continue;
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

}  // namespace

GrainRepresentatives grainRepresentatives(const LabelLeaves& labels, const Obstacles& obstacles,
                                          const VoxelWeights& weights, BondDepths* bonds,
                                          Interrupter* interrupter) {
  const LeafIndex& index = labels.index();
  if (index.leafCount() == 0) return {};
  if (obstacles.open && index.voxelCount() == obstacles.domain.voxelCount()) return {};
  const VoxelArray<int32_t> distances =
      squaredDistance(index, obstacles, weights, interrupter).values;
  if (bonds) addBondDepths(labels, {}, distances, *bonds, interrupter);
  return deepest(labels, {}, distances, interrupter);
}

void improve(const GrainRepresentatives& candidates, GrainRepresentatives& best) {
  for (const auto& [label, candidate] : candidates) improve(candidate, best[label]);
}

SlabRepresentatives::SlabRepresentatives(const CoordBBox& object, const Obstacles& obstacles,
                                         const VoxelWeights& weights, BondDepths* bonds)
    : domain_(object), weights_(weights), bonds_(bonds) {
  // The nearest background outside of the object's box is beside it.
  domain_.expand(1);
  if (obstacles.open) domain_ = obstacles.domain.box();
}

LeafLayers SlabRepresentatives::around(const LeafLayers& own) const {
  return {own.begin - reach_, own.end + reach_};
}

bool SlabRepresentatives::add(const LabelLeaves& labels, const LeafLayers& own,
                              Interrupter* interrupter) {
  const LeafIndex& index = labels.index();
  const LeafLayers known = around(own);
  CoordBBox box = domain_;
  box.min().z() = std::max(box.min().z(), known.begin);
  box.max().z() = std::min(box.max().z(), known.end - 1);
  const Obstacles obstacles{true, box};
  const bool goesOnBelow = box.min().z() > domain_.min().z(),
             goesOnAbove = box.max().z() < domain_.max().z();
  const auto refuse = [&] {
    reach_ *= 2;
    return false;
  };
  if (index.voxelCount() == obstacles.domain.voxelCount()) return refuse();
  const VoxelArray<int32_t> distances =
      squaredDistance(index, obstacles, weights_, interrupter).values;
  // No background that is not known lies nearer than that.
  const auto nearestUnknown = [&](int z) {
    int64_t nearest = std::numeric_limits<int64_t>::max();
    const auto takeSteps = [&](int64_t steps) {
      nearest = std::min(nearest, steps * steps * weights_.z);
    };
    if (goesOnBelow) takeSteps(int64_t(z) - box.min().z() + 1);
    if (goesOnAbove) takeSteps(int64_t(box.max().z()) - z + 1);
    return nearest;
  };
  std::atomic<bool> areExact{true};
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t leaf = begin; leaf < end && areExact; ++leaf) {
      const int z = index.origin(leaf).z();
      if (!own.hold(index.origin(leaf))) continue;
      const int32_t most =
          largest(distances.data() + index.firstRank(leaf), index.leafVoxels(leaf));
      // Bonds look at the voxels above, too, which may lie one deeper.
      if (most > std::min(nearestUnknown(z), nearestUnknown(z + (bonds_ ? 9 : 7))))
        areExact = false;
    }
  });
  if (!areExact) return refuse();
  if (bonds_) addBondDepths(labels, own, distances, *bonds_, interrupter);
  improve(deepest(labels, own, distances, interrupter), best);
  return true;
}

GrainRepresentatives grainRepresentatives(const Int32Grid& labels, const ManifoldGraph& graph) {
  GrainRepresentatives result;
  const auto accessor = labels.getConstUnsafeAccessor();
  for (const ManifoldGraph::Node& node : graph.nodes)
    improve({node.position, node.squaredRadius}, result[accessor.getValue(node.position)]);
  return result;
}

}  // namespace vdb_madf::detail
