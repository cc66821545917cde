// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/medial_balls.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/value_runs.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf {

namespace {

/// D(x) of the site x of a voxel p with the least power pi(p) = |p - x|^2 - D(x).
int32_t siteSquaredRadius(const LeafIndex& index, const VoxelWeights& weights, VoxelId voxel,
                          VoxelId site, int32_t power) {
  return int32_t(detail::squaredBetween(index.coord(voxel), index.coord(site), weights) - power);
}

}  // namespace

VoxelSet medialBalls(const LeafIndex& index, const PowerMap& map, Interrupter* interrupter) {
  VoxelSet balls(index.namedLeafCount());
  detail::parallelFor(index.leafCount(), detail::kLeafGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        VoxelId last = ~map.site[index.firstRank(begin)];
                        const size_t stop = index.firstRank(end);
                        for (size_t rank = index.firstRank(begin); rank < stop; rank += 64) {
                          const VoxelId* const sites = map.site.data() + rank;
                          const size_t count = std::min<size_t>(64, stop - rank);
                          detail::forEachBit(detail::runStarts(sites, count, last),
                                             [&](int i) { balls.insertAtomic(sites[i]); });
                          last = sites[count - 1];
                        }
                      });
  balls.rankMembers();
  return balls;
}

MedialBallTable measureBalls(const LeafIndex& index, const PowerMap& map, const VoxelSet& balls,
                             Interrupter* interrupter) {
  MedialBallTable table;
  table.cellSize.assign(balls.size(), 0);
  table.squaredRadius.assign(balls.size(), 0);
  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        // Neighbors along z mostly share their ball: count runs, add once.
        VoxelId first = 0, site = 0;
        int32_t power = 0;
        uint32_t run = 0;
        const auto flush = [&] {
          if (run == 0) return;
          const uint32_t ball = balls.rank(site);
          __atomic_fetch_add(&table.cellSize[ball], run, __ATOMIC_RELAXED);
          __atomic_store_n(&table.squaredRadius[ball],
                           siteSquaredRadius(index, map.weights, first, site, power),
                           __ATOMIC_RELAXED);
        };
        detail::forEachVoxel(index, begin, end, [&](VoxelId p, size_t rank) {
          if (run > 0 && map.site[rank] == site) {
            ++run;
            return;
          }
          flush();
          first = p;
          site = map.site[rank];
          power = map.power[rank];
          run = 1;
        });
        flush();
      });
  return table;
}

}  // namespace vdb_madf
