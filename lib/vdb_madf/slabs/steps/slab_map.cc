// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_map.h"

#include <utility>
#include <vector>

#include "vdb_madf/slabs/steps/slab_region.h"

namespace vdb_madf::detail {

PowerMap slabPowerMap(SlabWork& work, const SlabOffers& offers, size_t slab, LeafIndex& index,
                      Interrupter* interrupter) {
  if (work.facts.inRegion()) return powerMapInRegion(work, slab, index, interrupter);
  WorkPart measuring(interrupter, 0, 35), mapping(interrupter, 35, 100);
  SquaredDistance distance = squaredDistanceInSlab(index, work.facts.obstacles, work.facts.weights,
                                                   facesOf(work, slab), &measuring);
  work.store.write(kLargest, slab, {distance.largest, 0});
  distance.foreign = offers.received(slab, index);
  return powerMap(index, std::move(distance), &mapping);
}

void writeMap(SlabWork& work, size_t slab, const LeafIndex& index, const PowerMap& map) {
  std::vector<Coord> foreign;
  for (size_t leaf = index.leafCount(); leaf < index.namedLeafCount(); ++leaf)
    foreign.push_back(index.origin(leaf));
  work.store.write(kMapLeaves, slab, foreign);
  work.store.write(kMapSites, slab, map.site);
  work.store.write(kMapPowers, slab, map.power);
}

PowerMap readMap(const SlabWork& work, size_t slab, LeafIndex& index) {
  index.nameForeignLeaves(work.store.read(kMapLeaves, slab));
  PowerMap map;
  map.weights = work.facts.weights;
  map.site = work.store.read(kMapSites, slab);
  map.power = work.store.read(kMapPowers, slab);
  return map;
}

}  // namespace vdb_madf::detail
