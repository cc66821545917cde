// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/near_cuts.h"

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/slabs/detail/column_steps.h"

namespace vdb_madf::detail {

namespace {

LeafIndex leavesBetween(const LeafIndex& index, int begin, int end) {
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (const Coord& origin = index.origin(leaf); origin.z() >= begin && origin.z() < end)
      leaves.push_back({origin, index.mask(leaf)});
  return {LeafIndex(), leaves};
}

/// Does a ball of the layer `reach` voxels from the cut reach beyond it?
bool reachesBeyond(const LeafIndex& index, const VoxelArray<int32_t>& squaredRadius, int32_t weight,
                   const Cut& cut, int reach) {
  const int z = cut.isUpper ? cut.end - reach : cut.begin + reach - 1;
  const int64_t squaredReach = squaredAlong(reach, weight);
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != (z & ~7)) continue;
    bool any = false;
    forEachBit(layersAlongZ(index.mask(leaf))[size_t(z & 7)], [&](int row) {
      any |= squaredRadius[index.rank(leaf * 512 + uint32_t(row * 8 + (z & 7)))] > squaredReach;
    });
    if (any) return true;
  }
  return false;
}

}  // namespace

std::vector<ForeignSite> NearCuts::offers(bool isUpper) {
  constexpr int kFirstReach = 32;  // most balls are smaller
  const Cut cut{faces_.begin, faces_.end, isUpper};
  for (int reach = kFirstReach; reach < (faces_.end - faces_.begin) / 2; reach *= 2) {
    const SlabFaces faces = nearFaces(cut, reach);
    const LeafIndex index = leavesBetween(slab_, faces.begin, faces.end);
    const SquaredDistance distance = measure(index, faces);
    if (!reachesBeyond(index, distance.values, weights_.z, cut, reach))
      return siteOffers(index, distance.values, weights_.z, cut);
  }
  if (!whole_) whole_ = measure(slab_, faces_);
  return siteOffers(slab_, whole_->values, weights_.z, cut);
}

/// Of the part of the slab within reach of a cut: what the slab knows, and of its other end what the
/// rest of the slab tells.
SlabFaces NearCuts::nearFaces(const Cut& cut, int reach) const {
  SlabFaces faces = faces_, rest = faces_;
  const int height = faces_.end - faces_.begin - reach;  // of the rest
  if (cut.isUpper) {
    faces.begin = rest.end = cut.end - reach;
    faces.hasBelow = true;
    faces.below = passOn(columnSteps(slab_, obstacles_, rest, false), faces_.below, height);
  } else {
    faces.end = rest.begin = cut.begin + reach;
    faces.hasAbove = true;
    faces.above = passOn(columnSteps(slab_, obstacles_, rest, true), faces_.above, height);
  }
  return faces;
}

SquaredDistance NearCuts::measure(const LeafIndex& index, const SlabFaces& faces) const {
  return squaredDistanceInSlab(index, obstacles_, weights_, faces, interrupter_);
}

}  // namespace vdb_madf::detail
