// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/passage.h"

#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/pencil.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf::detail {

namespace {

/// The leaves of the box of a region, a voxel for each, that are up to reach(leaf) leaves away from
/// a leaf of the object. They grow within the box alone, which is convex.
template <typename Reach>
MaskTree leavesAround(const LeafIndex& object, const Domain& region, const Reach& reach) {
  const CoordBBox box{region.box().min() >> 3, region.box().max() >> 3};
  std::vector<std::vector<uint32_t>> byReach;
  for (uint32_t leaf = 0; leaf < object.leafCount(); ++leaf) {
    const auto r = size_t(reach(leaf));
    if (r >= byReach.size()) byReach.resize(r + 1);
    byReach[r].push_back(leaf);
  }
  MaskTree leaves;
  for (size_t r = byReach.size(); r-- > 0;) {  // those of the longest reach grow most often
    for (const uint32_t leaf : byReach[r]) leaves.setValueOn(object.origin(leaf) >> 3);
    if (r == 0) break;
    openvdb::tools::dilateActiveValues(leaves, 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    leaves.clip(box);
  }
  return leaves;
}

/// The unknown voxels of leaves.
std::vector<LeafIndex::LeafVoxels> unknownVoxels(const MaskTree& leaves, const Domain& region) {
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
  std::sort(unknown.begin(), unknown.end(), ByOrigin());
  return unknown;
}

int longestSide(const CoordBBox& box) {
  return box.dim()[int(box.maxExtent())];
}

using Marks = std::vector<uint8_t>;  // of leaves: 0 or 1

/// Marks all leaves of the pencils along an axis that hold a marked one.
Marks alongPencils(const LeafIndex& index, int axis, const Marks& marked) {
  Marks result(index.leafCount(), 0);
  std::vector<uint32_t> pencil;
  for (const uint32_t start : pencilStarts(index, axis)) {
    collectPencil(index, axis, start, pencil);
    const auto isMarked = [&](uint32_t leaf) { return marked[leaf] != 0; };
    if (std::none_of(pencil.begin(), pencil.end(), isMarked)) continue;
    for (const uint32_t leaf : pencil) result[leaf] = 1;
  }
  return result;
}

}  // namespace

Passage::Passage(const LeafIndex& object, const Domain& region, int reach,
                 const VoxelWeights& weights) {
  const int side = longestSide(region.box());
  const int leaves = (std::min(reach, side) + 7) / 8;
  exactUpTo_ = leaves * 8 >= side ? kInfinite
                                  : squaredAlong(uint32_t(leaves * 8), uint32_t(weights.least()));
  const auto all = [&](uint32_t) { return leaves; };
  index_ = LeafIndex(object, unknownVoxels(leavesAround(object, region, all), region));
  linkObject(object);
  chooseCarriers({0, 1, 2}, false);
}

Passage::Passage(const LeafIndex& object, const Domain& region,
                 const VoxelArray<int32_t>& squaredRadii, const VoxelWeights& weights) {
  const auto reach = [&](uint32_t leaf) {
    const int32_t* const first = squaredRadii.data() + object.firstRank(leaf);
    const int32_t largest = *std::max_element(first, first + object.leafVoxels(leaf));
    return (int(std::sqrt(double(largest) / weights.least())) + 7) / 8;
  };
  index_ = LeafIndex(object, unknownVoxels(leavesAround(object, region, reach), region));
  linkObject(object);
  chooseCarriers({2, 1, 0}, true);
}

void Passage::linkObject(const LeafIndex& object) {
  objectLeavesBefore_.reserve(index_.leafCount() + 1);
  uint32_t before = 0;
  for (size_t leaf = 0; leaf < index_.leafCount(); ++leaf) {
    objectLeavesBefore_.push_back(before);
    before += before < object.leafCount() && object.origin(before) == index_.origin(leaf);
  }
  objectLeavesBefore_.push_back(before);
}

void Passage::chooseCarriers(const std::array<int, 3>& axes, bool fromObject) {
  Marks object(index_.leafCount());
  for (size_t leaf = 0; leaf < object.size(); ++leaf) object[leaf] = hasObject(leaf);
  const auto along = [&](int pass, const Marks& marked) {
    return alongPencils(index_, axes[size_t(pass)], marked);
  };
  // Where later passes lead to the object, and where earlier ones come from it.
  const Marks toAfter1 = along(2, object), toAfter0 = along(1, toAfter1);
  const Marks everywhere(fromObject ? 0 : object.size(), 1);
  const Marks fromBy0 = fromObject ? along(0, object) : everywhere;
  const Marks fromBy1 = fromObject ? along(1, fromBy0) : everywhere;
  carries_.resize(object.size());
  for (size_t leaf = 0; leaf < object.size(); ++leaf)
    carries_[leaf] = uint8_t((toAfter0[leaf] & fromBy0[leaf]) |
                             (toAfter1[leaf] & fromBy1[leaf]) << 1 | object[leaf] << 2);
}

}  // namespace vdb_madf::detail
