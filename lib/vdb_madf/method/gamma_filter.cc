// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/gamma_filter.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/geodesic_completion.h"
#include "vdb_madf/method/detail/power_passes.h"

namespace vdb_madf {

namespace {

constexpr uint32_t kNoBall = ~uint32_t(0);

}  // namespace

VoxelSet keptBalls(const LeafIndex& index, const PowerMap& map, const VoxelSet& balls,
                   const MedialBallTable& table, int64_t gamma, Interrupter* interrupter) {
  if (gamma <= 1) return balls;
  VoxelSet kept(index.leafCount());
  const detail::ConnectedComponents components(index, interrupter);
  std::vector<char> hasKept(components.count(), 0);
  const std::vector<VoxelId> members = balls.members();
  for (uint32_t i = 0; i < members.size(); ++i) {
    if (table.cellSize[i] < gamma) continue;
    kept.insert(members[i]);
    hasKept[components.componentOf(members[i])] = 1;
  }
  std::vector<uint32_t> best(components.count(), kNoBall);
  const auto offer = [&](uint32_t component, uint32_t i) {
    uint32_t& b = best[component];
    if (b == kNoBall || table.squaredRadius[i] > table.squaredRadius[b] ||
        (table.squaredRadius[i] == table.squaredRadius[b] &&
         index.coord(members[i]) < index.coord(members[b])))
      b = i;
  };
  for (uint32_t i = 0; i < members.size(); ++i) {
    const uint32_t component = components.componentOf(members[i]);
    if (!hasKept[component]) offer(component, i);
  }
  if (map.passage) {  // balls may reach across what is unknown
    std::vector<char> hasNone(components.count(), 0);
    for (uint32_t c = 0; c < components.count(); ++c)
      hasNone[c] = !hasKept[c] && best[c] == kNoBall;
    for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
        for (uint32_t x = 0; x < 8 && hasNone[piece->component]; ++x)
          detail::forEachBit(piece->mask[x], [&](int bit) {
            const size_t rank = index.rank(voxelId(leaf, x, size_t(bit)));
            offer(piece->component, balls.rank(map.site[rank]));
          });
  }
  for (const uint32_t b : best)
    if (b != kNoBall) kept.insert(members[b]);
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
