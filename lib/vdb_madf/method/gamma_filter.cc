// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/gamma_filter.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/component_ball.h"
#include "vdb_madf/method/detail/geodesic_completion.h"
#include "vdb_madf/method/detail/power_passes.h"

namespace vdb_madf {

VoxelSet keptBalls(const LeafIndex& index, const PowerMap& map, const VoxelSet& balls,
                   const MedialBallTable& table, int64_t gamma, Interrupter* interrupter) {
  using detail::ComponentBall;
  if (gamma <= 1) return balls;
  VoxelSet kept(index.leafCount());
  const detail::ConnectedComponents components(index, interrupter);
  std::vector<ComponentBall> best(components.count());
  const std::vector<VoxelId> members = balls.members();
  for (uint32_t i = 0; i < members.size(); ++i) {
    const bool isKept = table.cellSize[i] >= gamma;
    if (isKept) kept.insert(members[i]);
    best[components.componentOf(members[i])].offer(
        {isKept ? ComponentBall::kept : ComponentBall::own, table.squaredRadius[i],
         index.coord(members[i])});
  }
  if (map.passage)  // balls may reach across what is unknown
    for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
        ComponentBall& ball = best[piece->component];
        for (uint32_t x = 0; x < 8 && ball.kind <= ComponentBall::elsewhere; ++x)
          detail::forEachBit(piece->mask[x], [&](int bit) {
            const VoxelId site = map.site[index.rank(voxelId(leaf, x, size_t(bit)))];
            ball.offer({ComponentBall::elsewhere, table.squaredRadius[balls.rank(site)],
                        index.coord(site)});
          });
      }
  for (const ComponentBall& ball : best)
    if (ball.isRescued()) kept.insert(*index.findVoxel(ball.center));
  kept.rankMembers();
  return kept;
}

PowerMap filteredPowerMap(const LeafIndex& index, PowerMap map, const VoxelSet& balls,
                          const MedialBallTable& table, const VoxelSet& kept,
                          Interrupter* interrupter) {
  detail::parallelFor(
      index.leafCount(), detail::kLeafGrain, interrupter, [&](size_t begin, size_t end) {
        const size_t first = index.firstRank(begin);
        std::fill_n(map.power.data() + first, index.firstRank(end) - first, kUncovered);
        for (size_t word = begin * 8; word < end * 8; ++word)
          detail::forEachBit(kept.word(word), [&](int bit) {
            const VoxelId id = VoxelId(word * 64) + VoxelId(bit);
            map.power[index.rank(id)] = -table.squaredRadius[balls.rank(id)];
          });
      });
  int32_t largest = 0;
  for (const int32_t radius2 : table.squaredRadius) largest = std::max(largest, radius2);
  detail::WorkPart sweeps(interrupter, 0, 75), rounds(interrupter, 75, 75);
  detail::sweepPower(index, largest, map, &sweeps);
  detail::GeodesicCompletion completion(index, map);
  completion.start(&rounds);
  while (completion.round(&rounds)) {
  }
  return map;
}

}  // namespace vdb_madf
