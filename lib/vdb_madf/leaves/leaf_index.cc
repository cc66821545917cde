// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/leaf_index.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf {

namespace {

struct SourceLeaf {
  Coord origin;
  const MaskTree::LeafNodeType* leaf;  // null: part of an active tile
};

void checkLeafCount(size_t leaves) {
  if (leaves > kMaxLeaves)
    throw InvalidInput("the object touches " + std::to_string(leaves) +
                       " leaf nodes, more than the " + std::to_string(kMaxLeaves) +
                       " that 32-bit voxel ids can hold: crop or coarsen the volume");
}

void checkExtent(const CoordBBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (box.min()[axis] < -kMaxCoordinate || box.max()[axis] > kMaxCoordinate)
      throw InvalidInput("the object has coordinates beyond +-" + std::to_string(kMaxCoordinate) +
                         ": move it nearer to the origin");
    if (int64_t(box.max()[axis]) - box.min()[axis] + 1 > kMaxExtent)
      throw InvalidInput("the object is longer than " + std::to_string(kMaxExtent) +
                         " voxels along an axis, beyond which squared distances overflow: crop or "
                         "coarsen the volume");
  }
}

/// The active bounding box; checks the limits before a tile is cut into leaves.
CoordBBox checkedBoundingBox(const MaskTree& tree) {
  size_t leaves = tree.leafCount();
  detail::forEachActiveTile(tree, [&](const CoordBBox& box) { leaves += box.volume() / 512; });
  checkLeafCount(leaves);
  CoordBBox box;
  if (!tree.evalActiveVoxelBoundingBox(box)) return {};
  checkExtent(box);
  return box;
}

/// The voxels of a leaf's mask.
CoordBBox maskBox(const Coord& origin, const LeafIndex::Mask& mask) {
  uint64_t anyX = 0;  // for each y and z: any x
  int first = 8, last = 0;
  for (int x = 0; x < 8; ++x) {
    if (mask[size_t(x)] == 0) continue;
    anyX |= mask[size_t(x)];
    first = std::min(first, x);
    last = x;
  }
  if (anyX == 0) return {};
  uint64_t anyXY = anyX | anyX >> 32;  // the eight bytes, one for each y, are put together
  anyXY |= anyXY >> 16;
  anyXY = (anyXY | anyXY >> 8) & 0xff;
  const auto lowest = [](uint64_t word) { return __builtin_ctzll(word); };
  const auto highest = [](uint64_t word) { return 63 - __builtin_clzll(word); };
  return {origin.offsetBy(first, lowest(anyX) / 8, lowest(anyXY)),
          origin.offsetBy(last, highest(anyX) / 8, highest(anyXY))};
}

std::vector<SourceLeaf> sortedLeaves(const MaskTree& tree) {
  std::vector<SourceLeaf> leaves;
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf)
    if (!leaf->isEmpty()) leaves.push_back({leaf->origin(), &*leaf});
  detail::forEachActiveTile(tree, [&](const CoordBBox& box) {
    detail::forEachLeafOrigin(box, [&](const Coord& origin) {
      leaves.push_back({origin, nullptr});
    });
  });
  detail::parallelSort(leaves.begin(), leaves.end(), ByOrigin());
  return leaves;
}

/// Links each leaf to the one 8 voxels further along an axis. Shifting keeps the order of origins,
/// so one merge-like walk finds all pairs.
void linkNeighbors(const std::vector<Coord>& origins, int axis,
                   std::vector<LeafIndex::Neighbors>& neighbors) {
  size_t j = 0;
  for (size_t i = 0; i < origins.size(); ++i) {
    Coord target = origins[i];
    target[axis] += 8;
    while (j < origins.size() && origins[j] < target) ++j;
    if (j < origins.size() && origins[j] == target) {
      neighbors[i][2 * axis + 1] = uint32_t(j);
      neighbors[j][2 * axis] = uint32_t(i);
    }
  }
}

}  // namespace

LeafIndex::LeafIndex(const MaskGrid& object) {
  const MaskTree& tree = object.constTree();
  boundingBox_ = checkedBoundingBox(tree);
  const std::vector<SourceLeaf> leaves = sortedLeaves(tree);
  origins_.resize(leaves.size());
  masks_.resize(leaves.size());
  for (size_t i = 0; i < leaves.size(); ++i) {
    origins_[i] = leaves[i].origin;
    masks_[i] = leaves[i].leaf ? detail::maskOf(*leaves[i].leaf) : detail::kFullMask;
  }
  finish();
}

LeafIndex::LeafIndex(const std::vector<LeafVoxels>& leaves) : LeafIndex(LeafIndex(), leaves) {}

LeafIndex::LeafIndex(const LeafIndex& object, const std::vector<LeafVoxels>& more)
    : boundingBox_(object.boundingBox_) {
  origins_.reserve(object.leafCount() + more.size());
  masks_.reserve(object.leafCount() + more.size());
  size_t i = 0;
  for (const LeafVoxels& leaf : more) {
    for (; i < object.leafCount() && object.origin(i) < leaf.origin; ++i) {
      origins_.push_back(object.origin(i));
      masks_.push_back(object.mask(i));
    }
    origins_.push_back(leaf.origin);
    masks_.push_back(leaf.mask);
    boundingBox_.expand(maskBox(leaf.origin, leaf.mask));
    if (i == object.leafCount() || object.origin(i) != leaf.origin) continue;
    for (size_t x = 0; x < 8; ++x) masks_.back()[x] |= object.mask(i)[x];
    ++i;
  }
  origins_.insert(origins_.end(), object.origins_.begin() + std::ptrdiff_t(i),
                  object.origins_.end());
  masks_.insert(masks_.end(), object.masks_.begin() + std::ptrdiff_t(i), object.masks_.end());
  checkLeafCount(leafCount());
  if (leafCount() > 0) checkExtent(boundingBox_);
  finish();
}

void LeafIndex::nameForeignLeaves(const std::vector<Coord>& origins) {
  checkLeafCount(leafCount() + origins.size());
  origins_.insert(origins_.end(), origins.begin(), origins.end());
}

std::optional<uint32_t> LeafIndex::findLeaf(const Coord& origin) const {
  const auto end = origins_.begin() + std::ptrdiff_t(leafCount());
  const auto found = std::lower_bound(origins_.begin(), end, origin);
  if (found == end || *found != origin) return std::nullopt;
  return uint32_t(found - origins_.begin());
}

std::optional<VoxelId> LeafIndex::findVoxel(const Coord& p) const {
  const auto leaf = findLeaf(p & ~7);
  if (!leaf || !detail::holds(masks_[*leaf], offsetOf(p))) return std::nullopt;
  return voxelId(*leaf, offsetOf(p));
}

void LeafIndex::finish() {
  neighbors_.assign(leafCount(), {kNone, kNone, kNone, kNone, kNone, kNone});
  firstRank_.resize(leafCount() + 1);
  wordRank_.resize(leafCount());
  constexpr size_t kGrain = 4096;  // leaves per task: some hundred microseconds
  detail::parallelForEach(leafCount(), kGrain, nullptr, [&](size_t i) {
    uint32_t count = 0;
    for (size_t x = 0; x < 8; ++x) {
      wordRank_[i][x] = uint16_t(count);
      count += detail::countBits(masks_[i][x]);
    }
    firstRank_[i + 1] = count;
  });
  for (size_t i = 0; i < leafCount(); ++i) firstRank_[i + 1] += firstRank_[i];
  detail::parallelForEach(3, 1, nullptr,
                          [&](size_t axis) { linkNeighbors(origins_, int(axis), neighbors_); });
}

}  // namespace vdb_madf
