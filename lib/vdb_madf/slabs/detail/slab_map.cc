// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_map.h"

#include <utility>
#include <vector>

#include "vdb_madf/slabs/detail/slab_region.h"

namespace vdb_madf::detail {

namespace {

// The pieces of a map.
constexpr char kForeignLeaves[] = "map-leaves", kSites[] = "map-sites", kPowers[] = "map-powers";

}  // namespace

PowerMap slabPowerMap(SlabWork& work, const SlabOffers& offers, size_t slab, LeafIndex& index,
                      Interrupter* interrupter) {
  if (work.inRegion()) return powerMapInRegion(work, slab, index, interrupter);
  WorkPart measuring(interrupter, 0, 35), mapping(interrupter, 35, 100);
  SquaredDistance distance =
      squaredDistanceInSlab(index, work.obstacles, work.weights, facesOf(work, slab), &measuring);
  work.writeVector(kLargest, slab, std::vector<int32_t>{distance.largest});
  distance.foreign = offers.received(slab, index);
  return powerMap(index, std::move(distance), &mapping);
}

void writeMap(SlabWork& work, size_t slab, const LeafIndex& index, const PowerMap& map) {
  std::vector<Coord> foreign;
  for (size_t leaf = index.leafCount(); leaf < index.namedLeafCount(); ++leaf)
    foreign.push_back(index.origin(leaf));
  work.writeVector(kForeignLeaves, slab, foreign);
  work.writeVoxels(kSites, slab, map.site);
  work.writeVoxels(kPowers, slab, map.power);
}

PowerMap readMap(const SlabWork& work, size_t slab, LeafIndex& index) {
  index.nameForeignLeaves(work.readVector<Coord>(kForeignLeaves, slab));
  PowerMap map;
  map.weights = work.weights;
  map.site = work.readVoxels<VoxelId>(kSites, slab);
  map.power = work.readVoxels<int32_t>(kPowers, slab);
  return map;
}

void forgetMap(SlabWork& work, size_t slab) {
  for (const char* what : {kForeignLeaves, kSites, kPowers}) work.remove(what, slab);
}

}  // namespace vdb_madf::detail
