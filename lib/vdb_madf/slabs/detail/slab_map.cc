// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_map.h"

#include <utility>
#include <vector>

#include "vdb_madf/slabs/detail/slab_region.h"

namespace vdb_madf::detail {

namespace {

constexpr char kMap[] = "map";

}  // namespace

PowerMap slabPowerMap(SlabWork& work, const SlabOffers& offers, size_t slab, LeafIndex& index,
                      Interrupter* interrupter) {
  if (work.inRegion()) return powerMapInRegion(work, slab, index, interrupter);
  WorkPart measuring(interrupter, 0, 35), mapping(interrupter, 35, 100);
  SquaredDistance distance = squaredDistanceInSlab(index, work.obstacles, work.weights,
                                                   facesOf(work, slab), &measuring);
  work.writeVector(kLargest, slab, std::vector<int32_t>{distance.largest});
  distance.foreign = offers.received(slab, index);
  return powerMap(index, std::move(distance), &mapping);
}

void writeMap(SlabWork& work, size_t slab, const LeafIndex& index, const PowerMap& map) {
  std::vector<Coord> foreign;
  for (size_t leaf = index.leafCount(); leaf < index.namedLeafCount(); ++leaf)
    foreign.push_back(index.origin(leaf));
  ByteWriter bytes;
  bytes.add(foreign);
  bytes.add(map.site);
  bytes.add(map.power);
  work.write(kMap, slab, bytes);
}

PowerMap readMap(const SlabWork& work, size_t slab, LeafIndex& index) {
  ByteReader bytes = work.read(kMap, slab);
  index.nameForeignLeaves(bytes.vector<Coord>());
  PowerMap map;
  map.weights = work.weights;
  map.site = bytes.voxelArray<VoxelId>();
  map.power = bytes.voxelArray<int32_t>();
  return map;
}

void forgetMap(SlabWork& work, size_t slab) {
  work.remove(kMap, slab);
}

}  // namespace vdb_madf::detail
