// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_region.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/squared_distance.h"

namespace vdb_madf::detail {

namespace {

bool isHere(const SlabWork& work, size_t slab) {
  return work.store.isShared() || (slab >= work.plan.firstOwn() && slab < work.plan.endOwn());
}

LeafIndex bodyOf(const SlabWork& work, size_t slab) {
  if (isHere(work, slab)) return work.body(slab).index;
  return LeafIndex(work.store.read(kAround, slab));
}

/// Does one of the slabs of a member lie within reach of a slab?
bool isNear(const SlabWork& work, int member, size_t slab, int64_t reach) {
  const size_t first = work.team.firstSlab(member, work.plan.slabCount()),
               last = work.team.firstSlab(member + 1, work.plan.slabCount());
  return first < last && work.plan.end(slab) + reach > work.plan.begin(first) &&
         work.plan.begin(slab) - reach < work.plan.end(last - 1);
}

/// The object as far as `reach` voxels beyond the cuts of a slab, in whole leaves.
LeafIndex window(const SlabWork& work, size_t slab, int reach) {
  const int64_t begin = int64_t(work.plan.begin(slab)) - reach,
                end = int64_t(work.plan.end(slab)) + reach;
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (size_t s = 0; s < work.plan.slabCount(); ++s) {
    if (work.plan.end(s) <= begin || work.plan.begin(s) >= end) continue;
    const LeafIndex index = bodyOf(work, s);
    for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
      const int z = index.origin(leaf).z();
      if (z + 8 > begin && z < end) leaves.push_back({index.origin(leaf), index.mask(leaf)});
    }
  }
  std::sort(leaves.begin(), leaves.end(), ByOrigin());
  return LeafIndex(leaves);
}

/// Voxels along z within which balls of that squared radius reach.
int reachOf(const SlabWork& work, int64_t largest) {
  return int(std::sqrt(double(largest) / work.facts.weights.z)) + 1;
}

bool holdsAll(const SlabWork& work, size_t slab, int reach) {
  return work.plan.begin(slab) - int64_t(reach) <= work.plan.object.cuts.front() &&
         work.plan.end(slab) + int64_t(reach) >= work.plan.object.cuts.back();
}

/// The part of a map of a window that lies in a slab. Leaves of the window elsewhere are foreign.
PowerMap partOf(PowerMap map, const LeafIndex& window, LeafIndex& index) {
  PowerMap part;
  part.weights = map.weights;
  part.site = VoxelArray<VoxelId>(size_t(index.voxelCount()));
  part.power = VoxelArray<int32_t>(size_t(index.voxelCount()));
  std::vector<uint32_t> nameOf;  // of a leaf of the window
  std::vector<Coord> foreign;
  for (size_t leaf = 0; leaf < window.leafCount(); ++leaf) {
    const auto own = index.findLeaf(window.origin(leaf));
    nameOf.push_back(own ? *own : uint32_t(index.leafCount() + foreign.size()));
    if (!own) foreign.push_back(window.origin(leaf));
  }
  index.nameForeignLeaves(foreign);
  for (size_t leaf = 0; leaf < window.leafCount(); ++leaf) {
    if (nameOf[leaf] >= index.leafCount()) continue;
    const size_t from = window.firstRank(leaf), to = index.firstRank(nameOf[leaf]);
    for (size_t i = 0; i < window.leafVoxels(leaf); ++i) {
      part.power[to + i] = map.power[from + i];
      const VoxelId site = map.site[from + i];  // none where nothing covers a voxel
      if (map.power[from + i] < 0)
        part.site[to + i] = voxelId(nameOf[leafOf(site)], offsetOf(site));
    }
  }
  return part;
}

SquaredDistance distanceIn(const SlabWork& work, const LeafIndex& window,
                           Interrupter* interrupter) {
  return squaredDistance(window, work.facts.obstacles, work.facts.weights, interrupter);
}

}  // namespace

void shareBodies(SlabWork& work, int reach) {
  if (work.team.count() == 1 || work.store.isShared()) return;
  for (size_t s = work.plan.firstOwn(); s < work.plan.endOwn(); ++s) {
    const LeafIndex index = work.body(s).index;
    std::vector<LeafIndex::LeafVoxels> leaves;
    for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
      leaves.push_back({index.origin(leaf), index.mask(leaf)});
    for (int member = 0; member < work.team.count(); ++member)
      if (member != work.team.member() && isNear(work, member, s, reach))
        work.store.give(member, kAround, s, leaves);
  }
  work.steps.exchange();
}

void forgetBodies(SlabWork& work) {
  for (size_t s = 0; s < work.plan.slabCount(); ++s) work.store.remove(kAround, s);
}

std::optional<int32_t> largestInRegion(const SlabWork& work, size_t slab, int reach,
                                       Interrupter* interrupter) {
  const LeafIndex own = work.body(slab).index;
  if (own.voxelCount() == 0) return 0;
  const LeafIndex seen = window(work, slab, reach);
  const SquaredDistance distance = distanceIn(work, seen, interrupter);
  int32_t largest = 0;
  for (size_t leaf = 0; leaf < own.leafCount(); ++leaf) {
    const uint32_t there = *seen.findLeaf(own.origin(leaf));
    const int32_t* const first = distance.values.data() + seen.firstRank(there);
    largest = std::max(largest, *std::max_element(first, first + seen.leafVoxels(there)));
  }
  if (!holdsAll(work, slab, reach) && reachOf(work, largest) > reach) return std::nullopt;
  return largest;
}

int mappedReach(const SlabWork& work) {
  // Balls that reach the slab are as far away as their radius, and measured rightly if the window
  // goes on as far again. Others are at most too small, and reach it even less.
  return 2 * reachOf(work, work.facts.largestSquaredDistance);
}

PowerMap powerMapInRegion(const SlabWork& work, size_t slab, LeafIndex& index,
                          Interrupter* interrupter) {
  const LeafIndex seen = window(work, slab, mappedReach(work));
  WorkPart measuring(interrupter, 0, 35), mapping(interrupter, 35, 100);
  return partOf(powerMap(seen, distanceIn(work, seen, &measuring), &mapping), seen, index);
}

PowerMap filteredInRegion(const SlabWork& work, size_t slab, const std::vector<ForeignSite>& sites,
                          LeafIndex& index, Interrupter* interrupter) {
  const LeafIndex seen = window(work, slab, mappedReach(work));
  WorkPart measuring(interrupter, 0, 35), mapping(interrupter, 35, 100);
  PowerMap map;
  map.weights = work.facts.weights;
  map.passage = distanceIn(work, seen, &measuring).passage;
  map.site = VoxelArray<VoxelId>(size_t(seen.voxelCount()));
  map.power = VoxelArray<int32_t>(size_t(seen.voxelCount()));
  for (size_t i = 0; i < map.power.size(); ++i) map.power[i] = kUncovered;
  for (const ForeignSite& site : sites)
    if (const auto id = seen.findVoxel(site.position))
      map.power[seen.rank(*id)] = -site.squaredRadius;
  sweepPower(seen, work.facts.largestSquaredDistance, map, &mapping);
  return partOf(std::move(map), seen, index);
}

bool isInReach(const SlabWork& work, size_t slab, size_t other) {
  const int64_t reach = reachOf(work, work.facts.largestSquaredDistance);
  return work.plan.end(other) + reach > work.plan.begin(slab) &&
         work.plan.begin(other) - reach < work.plan.end(slab);
}

}  // namespace vdb_madf::detail
