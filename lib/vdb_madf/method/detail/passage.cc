// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/passage.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf::detail {

namespace {

/// The unknown voxels of the leaves up to `leaves` away from the object's, as far as the box of the
/// region goes.
std::vector<LeafIndex::LeafVoxels> unknownVoxels(const LeafIndex& object, const Domain& region,
                                                 int leaves) {
  MaskTree near;  // a voxel stands for a leaf
  for (size_t leaf = 0; leaf < object.leafCount(); ++leaf)
    near.setValueOn(object.origin(leaf) >> 3);
  openvdb::tools::dilateActiveValues(near, leaves, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                     openvdb::tools::EXPAND_TILES);
  near.clip({region.box().min() >> 3, region.box().max() >> 3});
  std::vector<LeafIndex::LeafVoxels> unknown;
  for (auto at = near.cbeginValueOn(); at; ++at) {
    CoordBBox tile;
    at.getBoundingBox(tile);
    for (const Coord& place : tile) {
      const Coord origin(place.x() * 8, place.y() * 8, place.z() * 8);
      const LeafIndex::Mask mask = without(kFullMask, insideMask(region, origin));
      if (anyVoxel(mask)) unknown.push_back({origin, mask});
    }
  }
  std::sort(unknown.begin(), unknown.end(),
            [](const auto& a, const auto& b) { return a.origin < b.origin; });
  return unknown;
}

int longestSide(const CoordBBox& box) {
  return box.dim()[int(box.maxExtent())];
}

/// What of a leaf here belongs to the object, packed.
template <typename T>
void packObject(const LeafIndex::Mask& here, const LeafIndex::Mask& object, const T* values,
                T* packed) {
  T dense[512];
  expandLeaf(here, values, dense);
  packLeaf(object, dense, packed);
}

}  // namespace

Passage::Passage(const LeafIndex& object, const Domain& region, int reach,
                 const VoxelWeights& weights) {
  const int side = longestSide(region.box());
  const int leaves = (std::min(reach, side) + 7) / 8;
  exactUpTo_ = leaves * 8 >= side ? kInfinite
                                  : squaredAlong(uint32_t(leaves * 8), uint32_t(weights.least()));
  index_ = LeafIndex(object, unknownVoxels(object, region, leaves));
  leafOfObject_.assign(index_.leafCount(), LeafIndex::kNone);
  leafHere_.reserve(object.leafCount());
  for (uint32_t here = 0; leafHere_.size() < object.leafCount(); ++here) {
    if (index_.origin(here) != object.origin(leafHere_.size())) continue;
    leafOfObject_[here] = uint32_t(leafHere_.size());
    leafHere_.push_back(here);
  }
}

VoxelArray<int32_t> Passage::spread(const LeafIndex& object, const VoxelArray<int32_t>& values,
                                    int32_t unknown) const {
  VoxelArray<int32_t> result(size_t(index_.voxelCount()));
  parallelFor(index_.leafCount(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    int32_t dense[512];
    for (size_t here = begin; here < end; ++here) {
      const uint32_t leaf = leafOfObject_[here];
      if (leaf == LeafIndex::kNone) {
        std::fill_n(dense, 512, unknown);
      } else {
        expandLeaf(object.mask(leaf), values.data() + object.firstRank(leaf), dense);
        const LeafIndex::Mask added = without(index_.mask(here), object.mask(leaf));
        for (size_t x = 0; x < 8; ++x)
          forEachBit(added[x], [&](int bit) { dense[x * 64 + size_t(bit)] = unknown; });
      }
      packLeaf(index_.mask(here), dense, result.data() + index_.firstRank(here));
    }
  });
  return result;
}

void Passage::collect(const LeafIndex& object, const VoxelArray<int32_t>& values,
                      VoxelArray<int32_t>& ofObject) const {
  parallelFor(object.leafCount(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const uint32_t here = leafHere_[leaf];
      packObject(index_.mask(here), object.mask(leaf), values.data() + index_.firstRank(here),
                 ofObject.data() + object.firstRank(leaf));
    }
  });
}

void Passage::collectIds(const LeafIndex& object, const VoxelArray<VoxelId>& ids,
                         VoxelArray<VoxelId>& ofObject) const {
  parallelFor(object.leafCount(), kLeafGrain, nullptr, [&](size_t begin, size_t end) {
    for (size_t leaf = begin; leaf < end; ++leaf) {
      const uint32_t here = leafHere_[leaf];
      VoxelId* const packed = ofObject.data() + object.firstRank(leaf);
      packObject(index_.mask(here), object.mask(leaf), ids.data() + index_.firstRank(here), packed);
      for (size_t i = 0; i < object.leafVoxels(leaf); ++i)
        packed[i] = leafOfObject_[leafOf(packed[i])] * 512 + offsetOf(packed[i]);
    }
  });
}

}  // namespace vdb_madf::detail
