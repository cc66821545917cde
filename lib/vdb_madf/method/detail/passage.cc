// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/passage.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf::detail {

namespace {

/// The leaves, a voxel for each, that are up to reach(leaf) leaves away from a leaf of the object.
template <typename Reach>
MaskTree leavesAround(const LeafIndex& object, const Reach& reach) {
  std::vector<std::vector<uint32_t>> byReach;
  for (uint32_t leaf = 0; leaf < object.leafCount(); ++leaf) {
    const auto r = size_t(reach(leaf));
    if (r >= byReach.size()) byReach.resize(r + 1);
    byReach[r].push_back(leaf);
  }
  MaskTree leaves;
  for (size_t r = byReach.size(); r-- > 0;) {  // those of the longest reach grow most often
    for (const uint32_t leaf : byReach[r]) leaves.setValueOn(object.origin(leaf) >> 3);
    if (r > 0)
      openvdb::tools::dilateActiveValues(leaves, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                         openvdb::tools::EXPAND_TILES);
  }
  return leaves;
}

/// The unknown voxels of leaves, as far as the box of the region goes.
std::vector<LeafIndex::LeafVoxels> unknownVoxels(MaskTree leaves, const Domain& region) {
  leaves.clip({region.box().min() >> 3, region.box().max() >> 3});
  std::vector<LeafIndex::LeafVoxels> unknown;
  for (auto at = leaves.cbeginValueOn(); at; ++at) {
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
  index_ = LeafIndex(object,
                     unknownVoxels(leavesAround(object, [&](uint32_t) { return leaves; }), region));
  linkLeaves(object);
}

Passage::Passage(const LeafIndex& object, const Domain& region,
                 const VoxelArray<int32_t>& squaredRadii, const VoxelWeights& weights) {
  const auto reach = [&](uint32_t leaf) {
    const int32_t* const first = squaredRadii.data() + object.firstRank(leaf);
    const int32_t largest = *std::max_element(first, first + object.leafVoxels(leaf));
    return (int(std::sqrt(double(largest) / weights.least())) + 7) / 8;
  };
  index_ = LeafIndex(object, unknownVoxels(leavesAround(object, reach), region));
  linkLeaves(object);
}

void Passage::linkLeaves(const LeafIndex& object) {
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
