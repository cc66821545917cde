// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/gamma_filter.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/detail/power_passes.h"

namespace vdb_madf {

namespace {

constexpr VoxelId kNoSite = ~VoxelId(0);
constexpr uint32_t kNoBall = ~uint32_t(0);

/// Completes the voxels that no kept ball covers.
class GeodesicCompletion {
 public:
  GeodesicCompletion(const LeafIndex& index, PowerMap& map) : index_(index), map_(map) {}

  void run(Interrupter* interrupter) {
    uncovered_ = VoxelSet(index_.leafCount());
    front_ = VoxelSet(index_.leafCount());
    findUncovered(interrupter);
    front_ = uncovered_;
    while (round(interrupter)) {
    }
  }

 private:
  struct Change {
    VoxelId voxel, site;
    int32_t power;
  };

  void findUncovered(Interrupter* interrupter) {
    detail::parallelFor(index_.leafCount(), detail::kLeafGrain, interrupter,
                        [&](size_t begin, size_t end) {
                          detail::forEachVoxel(index_, begin, end, [&](VoxelId p, size_t rank) {
                            if (map_.power[rank] < 0) return;
                            uncovered_.insert(p);  // a word belongs to one leaf, so to one thread
                            map_.site[rank] = kNoSite;
                          });
                        });
  }

  /// Is site a better than b at equal power at p? The larger D wins, then the smaller coordinate.
  /// At equal power |p - a|^2 - D(a) = |p - b|^2 - D(b) the larger D is that of the farther site.
  bool winsTie(const Coord& p, VoxelId a, VoxelId b) const {
    const Coord siteA = index_.coord(a), siteB = index_.coord(b);
    const int64_t awayA = detail::squaredBetween(p, siteA, map_.weights),
                  awayB = detail::squaredBetween(p, siteB, map_.weights);
    return awayA != awayB ? awayA > awayB : siteA < siteB;
  }

  /// The best of a voxel's own site and those of its neighbors q = p + step e. The power of q's
  /// site x here follows from that at q: pi_x(p) = pi_x(q) + |p - x|^2 - |q - x|^2.
  Change best(VoxelId p) const {
    const size_t rank = index_.rank(p);
    Change best{p, map_.site[rank], map_.power[rank]};
    const Coord position = index_.coord(p);
    detail::forEachNeighbor(index_, p, [&](VoxelId q, int axis, int step) {
      if (!detail::isObject(index_, q)) return;
      const size_t neighbor = index_.rank(q);
      const VoxelId site = map_.site[neighbor];
      if (site == kNoSite || site == best.site) return;
      const int away = position[axis] - index_.coord(site)[axis];
      const int32_t power =
          map_.power[neighbor] - detail::addedByStep(away, step, map_.weights[axis]);
      if (best.site == kNoSite || power < best.power ||
          (power == best.power && winsTie(position, site, best.site)))
        best = {p, site, power};
    });
    return best;
  }

  /// One synchronous round: decide for all voxels of the front from the state before it, then
  /// write. Only voxels beside a change can change in the next round. False if nothing changed.
  bool round(Interrupter* interrupter) {
    // Chunks of words with something to do; each keeps its own list, so nothing depends on threads.
    std::vector<uint32_t> words;
    for (size_t i = 0; i < front_.wordCount(); ++i)
      if (front_.word(i)) words.push_back(uint32_t(i));
    constexpr size_t kWordsPerChunk = 256;
    std::vector<std::vector<Change>> changes((words.size() + kWordsPerChunk - 1) / kWordsPerChunk);
    detail::parallelFor(changes.size(), 1, interrupter, [&](size_t begin, size_t end) {
      for (size_t chunk = begin; chunk < end; ++chunk) {
        const size_t last = std::min(words.size(), (chunk + 1) * kWordsPerChunk);
        for (size_t w = chunk * kWordsPerChunk; w < last; ++w) {
          uint64_t& word = front_.word(words[w]);
          detail::forEachBit(word, [&](int bit) {
            const Change change = best(VoxelId(words[w]) * 64 + VoxelId(bit));
            if (change.site != map_.site[index_.rank(change.voxel)])
              changes[chunk].push_back(change);
          });
          word = 0;
        }
      }
    });
    std::atomic<bool> changed{false};
    detail::parallelFor(changes.size(), 1, interrupter, [&](size_t begin, size_t end) {
      for (size_t chunk = begin; chunk < end; ++chunk) {
        for (const Change& change : changes[chunk]) {
          const size_t rank = index_.rank(change.voxel);
          map_.site[rank] = change.site;
          map_.power[rank] = change.power;
          detail::forEachNeighbor(index_, change.voxel, [&](VoxelId q, int, int) {
            if (uncovered_.contains(q)) front_.insertAtomic(q);
          });
        }
        if (!changes[chunk].empty()) changed = true;
      }
    });
    return changed;
  }

  const LeafIndex& index_;
  PowerMap& map_;
  VoxelSet uncovered_;
  VoxelSet front_;  // uncovered voxels beside a change of the last round
};

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
            const size_t rank = index.rank(leaf * 512 + x * 64 + uint32_t(bit));
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
        detail::forEachVoxel(index, begin, end, [&](VoxelId p, size_t rank) {
          map.power[rank] = kept.contains(p) ? -table.squaredRadius[balls.rank(p)] : kUncovered;
        });
      });
  int32_t largest = 0;
  for (const int32_t radius2 : table.squaredRadius) largest = std::max(largest, radius2);
  detail::WorkPart sweeps(interrupter, 0, 75), rounds(interrupter, 75, 75);
  detail::sweepPower(index, largest, map, &sweeps);
  GeodesicCompletion(index, map).run(&rounds);
  return map;
}

}  // namespace vdb_madf
