// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/detail/grain_representatives.h"

#include <unordered_map>

#include "vdb_madf/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kLeafGrain = 256;

/// Takes over what is deeper; leaves may come in any order.
void improve(const GrainRepresentative& candidate, GrainRepresentative& best) {
  if (candidate.squaredRadius > best.squaredRadius ||
      (candidate.squaredRadius == best.squaredRadius && candidate.voxel < best.voxel))
    best = candidate;
}

}  // namespace

std::map<int32_t, GrainRepresentative> grainRepresentatives(const LabelLeaves& labels,
                                                            const Obstacles& obstacles,
                                                            Interrupter* interrupter) {
  std::map<int32_t, GrainRepresentative> result;
  const LeafIndex& index = labels.index();
  if (index.leafCount() == 0) return result;
  if (obstacles.open && uint64_t(index.voxelCount()) == obstacles.domain.volume()) return result;
  const VoxelArray<int32_t> distances = squaredDistance(index, obstacles, interrupter).values;
  using Best = std::unordered_map<int32_t, GrainRepresentative>;
  PerThread<Best> bests;
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    Best& best = bests.local();
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const Coord& origin = index.origin(leaf);
      const int32_t* d = distances.data() + index.firstRank(leaf);
      GrainRepresentative deepest;  // of a run of voxels of the same label
      int32_t last = 0;
      for (int x = 0; x < 8; ++x) {
        for (uint64_t word = index.mask(leaf)[size_t(x)]; word; word &= word - 1, ++d) {
          const int offset = x * 64 + __builtin_ctzll(word);
          const int32_t label = labels.label(leaf, offset);
          if (label != last) {
            if (last) improve(deepest, best[last]);
            last = label;
            deepest = GrainRepresentative();
          }
          // Voxels come in the order that decides ties.
          if (*d > deepest.squaredRadius)
            deepest = {origin.offsetBy(x, offset >> 3 & 7, offset & 7), *d};
        }
      }
      if (last) improve(deepest, best[last]);
    }
  });
  for (const Best& best : bests)
    for (const auto& [label, representative] : best) improve(representative, result[label]);
  return result;
}

}  // namespace vdb_madf::detail
