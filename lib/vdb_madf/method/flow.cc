// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/flow.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

/// Follows the sites from ball to ball: the critical ball that each one flows to, by rank. Other
/// threads may shorten a path while this one walks it; all lead to one root.
std::vector<uint32_t> rootBalls(const LeafIndex& index, const VoxelArray<VoxelId>& site,
                                const VoxelSet& balls, const std::vector<VoxelId>& ids,
                                Interrupter* interrupter) {
  constexpr size_t kBallGrain = 4096;
  std::vector<uint32_t> next(ids.size());
  detail::parallelFor(ids.size(), kBallGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      next[i] = index.isForeign(ids[i]) ? uint32_t(i) : balls.rank(site[index.rank(ids[i])]);
  });
  detail::parallelFor(ids.size(), kBallGrain, interrupter, [&](size_t begin, size_t end) {
    const auto load = [&](size_t i) { return __atomic_load_n(&next[i], __ATOMIC_RELAXED); };
    for (size_t i = begin; i < end; ++i) {
      uint32_t root = load(i);
      for (uint32_t further; (further = load(root)) != root;) root = further;
      __atomic_store_n(&next[i], root, __ATOMIC_RELAXED);
    }
  });
  return next;
}

/// The ranks of the fixed points among the balls, in lexicographic order of position.
std::vector<uint32_t> fixedPoints(const LeafIndex& index, const std::vector<VoxelId>& ids,
                                  const std::vector<uint32_t>& root) {
  std::vector<uint32_t> fixed;
  for (uint32_t i = 0; i < ids.size(); ++i)
    if (root[i] == i) fixed.push_back(i);
  std::sort(fixed.begin(), fixed.end(),
            [&](uint32_t a, uint32_t b) { return index.coord(ids[a]) < index.coord(ids[b]); });
  return fixed;
}

/// What Flow::manifold holds for the voxels of each ball's cell.
std::vector<uint32_t> manifoldOfBall(const std::vector<uint32_t>& root,
                                     const std::vector<uint32_t>& fixed) {
  std::vector<uint32_t> manifold(root.size());
  for (uint32_t i = 0; i < fixed.size(); ++i) manifold[fixed[i]] = (i + 1) | Flow::kOwnCell;
  for (uint32_t i = 0; i < root.size(); ++i)
    if (root[i] != i) manifold[i] = manifold[root[i]] & ~Flow::kOwnCell;
  return manifold;
}

/// Replaces each voxel's site by its manifold, and counts the voxels of each manifold.
void replaceSites(const LeafIndex& index, const VoxelSet& balls,
                  const std::vector<uint32_t>& manifold, VoxelArray<VoxelId>& site,
                  std::vector<CriticalPoint>& criticalPoints, Interrupter* interrupter) {
  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        // Neighbors along z mostly share their ball: look up and count by runs.
        VoxelId ball = 0;
        uint32_t number = 0;
        int64_t run = 0;
        const auto flush = [&] {
          if (run > 0)
            __atomic_fetch_add(&criticalPoints[(number & ~Flow::kOwnCell) - 1].voxels, run,
                               __ATOMIC_RELAXED);
        };
        const size_t stop = index.firstRank(end);
        for (size_t rank = index.firstRank(begin); rank < stop; ++rank) {
          if (number == 0 || site[rank] != ball) {
            ball = site[rank];
            const uint32_t found = manifold[balls.rank(ball)];
            if (found != number) {
              flush();
              number = found;
              run = 0;
            }
          }
          ++run;
          site[rank] = number;
        }
        flush();
      });
}

}  // namespace

Flow flow(const LeafIndex& index, VoxelArray<VoxelId> site, const VoxelArray<int32_t>& power,
          const VoxelSet& balls, Interrupter* interrupter) {
  const std::vector<VoxelId> ids = balls.members();
  const std::vector<uint32_t> root = rootBalls(index, site, balls, ids, interrupter);
  const std::vector<uint32_t> fixed = fixedPoints(index, ids, root);
  Flow result;
  result.criticalPoints.reserve(fixed.size());
  for (const uint32_t i : fixed)  // at a fixed point the power is -D
    result.criticalPoints.push_back(
        {index.coord(ids[i]), index.isForeign(ids[i]) ? 0 : -power[index.rank(ids[i])], 0});
  replaceSites(index, balls, manifoldOfBall(root, fixed), site, result.criticalPoints, interrupter);
  result.manifold = std::move(site);
  return result;
}

}  // namespace vdb_madf
