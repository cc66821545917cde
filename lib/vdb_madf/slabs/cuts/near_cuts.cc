// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/near_cuts.h"

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/slabs/cuts/column_steps.h"

namespace vdb_madf::detail {

namespace {

std::vector<LeafIndex::LeafVoxels> leavesBetween(const LeafIndex& index, int begin, int end) {
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (const Coord& origin = index.origin(leaf); origin.z() >= begin && origin.z() < end)
      leaves.push_back({origin, index.mask(leaf)});
  return leaves;
}

/// Does a ball of the layer `reach` voxels from the cut reach beyond it?
bool reachesBeyond(const LeafIndex& index, const VoxelArray<int32_t>& squaredRadius, int32_t weight,
                   const Cut& cut, int reach) {
  const int z = cut.isUpper ? cut.end - reach : cut.begin + reach - 1;
  const int64_t squaredReach = squaredAlong(int64_t(reach), weight);
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != (z & ~7)) continue;
    bool any = false;
    forEachBit(layersAlongZ(index.mask(leaf))[size_t(z & 7)], [&](int row) {
      any |= squaredRadius[index.rank(voxelId(leaf, size_t(row * 8 + (z & 7))))] > squaredReach;
    });
    if (any) return true;
  }
  return false;
}

}  // namespace

std::vector<ForeignSite> NearCuts::offers(bool isUpper) {
  constexpr int kFirstReach = 16;  // a multiple of 8; about the largest balls of most objects
  const Cut cut{faces_.begin, faces_.end, isUpper};
  const int height = faces_.end - faces_.begin;
  for (int reach = kFirstReach; !whole_ && reach < height / 2; reach *= 2) {
    const SlabFaces faces = nearFaces(cut, reach);
    const LeafIndex index(leavesBetween(slab_, faces.begin, faces.end));
    const SquaredDistance distance = measure(index, faces, isUpper);
    if (!reachesBeyond(index, distance.values, weights_.z, cut, reach))
      return siteOffers(index, distance.values, weights_.z, cut);
  }
  if (!whole_) whole_ = measure(slab_, faces_, isUpper);
  return siteOffers(slab_, whole_->values, weights_.z, cut);
}

/// Of the layers within reach of a cut: at their other end, what the rest of the slab tells.
SlabFaces NearCuts::nearFaces(const Cut& cut, int reach) const {
  const int height = faces_.end - faces_.begin - reach;  // of the rest
  SlabFaces near, rest;
  near.begin = rest.begin = faces_.begin;
  near.end = rest.end = faces_.end;
  near.hasBelow = rest.hasBelow = faces_.hasBelow;
  near.hasAbove = rest.hasAbove = faces_.hasAbove;
  if (cut.isUpper) {
    near.begin = rest.end = cut.end - reach;
    near.hasBelow = true;
    near.below = passOn(columnSteps(slab_, obstacles_, rest, false), faces_.below, height);
    near.above = faces_.above;
  } else {
    near.end = rest.begin = cut.begin + reach;
    near.hasAbove = true;
    near.above = passOn(columnSteps(slab_, obstacles_, rest, true), faces_.above, height);
    near.below = faces_.below;
  }
  return near;
}

SquaredDistance NearCuts::measure(const LeafIndex& index, const SlabFaces& faces,
                                  bool isUpper) const {
  WorkPart part(interrupter_, isUpper ? 0 : 50, isUpper ? 50 : 100);
  return squaredDistanceInSlab(index, obstacles_, weights_, faces, &part);
}

}  // namespace vdb_madf::detail
