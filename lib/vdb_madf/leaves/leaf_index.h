// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf {

/// Position of a voxel in a LeafIndex: leaf * 512 + offset, offset = x*64 + y*8 + z within the
/// leaf. A voxel is a bit of a word in its leaf's mask (see LeafIndex::Mask).
using VoxelId = uint32_t;

constexpr VoxelId voxelId(size_t leaf, size_t offset) {
  return VoxelId(leaf << 9 | offset);
}
constexpr VoxelId voxelId(size_t leaf, size_t word, size_t bit) {
  return VoxelId(leaf << 9 | word << 6 | bit);
}
constexpr uint32_t leafOf(VoxelId id) {
  return id >> 9;
}
constexpr uint32_t offsetOf(VoxelId id) {
  return id & 511;
}
constexpr uint32_t wordOf(VoxelId id) {  ///< x within the leaf
  return id >> 6 & 7;
}
constexpr uint32_t bitOf(VoxelId id) {  ///< y*8 + z within the leaf
  return id & 63;
}
inline uint32_t offsetOf(const Coord& p) {
  return uint32_t((p.x() & 7) << 6 | (p.y() & 7) << 3 | (p.z() & 7));
}

/// The topology of the object X: its 8x8x8 leaves sorted by origin (x, then y, then z), their masks
/// and their six neighbors. The one place that knows the topology; every stage works on it.
class LeafIndex {
 public:
  static constexpr uint32_t kNone = 0xffffffffu;  ///< no neighbor

  /// Bit y*8 + z of word x is voxel (x, y, z) of the leaf.
  using Mask = std::array<uint64_t, 8>;
  /// -x, +x, -y, +y, -z, +z; kNone where there is no leaf.
  using Neighbors = std::array<uint32_t, 6>;

  LeafIndex() = default;
  /// Active voxels of the mask, active tiles included.
  /// @throw InvalidInput if there are more than kMaxLeaves leaves (tiles counted as leaves), the
  ///   object is longer than kMaxExtent along an axis, or has coordinates beyond kMaxCoordinate.
  explicit LeafIndex(const MaskGrid& object);

  /// Voxels of one leaf.
  struct LeafVoxels {
    Coord origin;
    Mask mask;
  };
  /// Leaves that ascend by origin (ByOrigin), each origin once. @throw InvalidInput as above.
  explicit LeafIndex(const std::vector<LeafVoxels>& leaves);
  /// The voxels of `object` and `more` besides, which ascends by origin, each origin once.
  /// @throw InvalidInput as above.
  LeafIndex(const LeafIndex& object, const std::vector<LeafVoxels>& more);

  /// Names voxels elsewhere, too: those of the leaf at origins[i] get the ids of the leaf number
  /// namedLeafCount() + i of before. Nothing but coord(), origin() and isForeign() takes them.
  void nameForeignLeaves(const std::vector<Coord>& origins);
  bool isForeign(VoxelId id) const { return leafOf(id) >= leafCount(); }
  size_t namedLeafCount() const { return origins_.size(); }  ///< counts the foreign ones, too

  size_t leafCount() const { return masks_.size(); }
  int64_t voxelCount() const { return firstRank_.back(); }  ///< |X|, size of a VoxelArray
  /// The box of the active voxels; empty if there are none.
  const CoordBBox& boundingBox() const { return boundingBox_; }

  const Coord& origin(size_t leaf) const { return origins_[leaf]; }
  const Mask& mask(size_t leaf) const { return masks_[leaf]; }
  const Neighbors& neighbors(size_t leaf) const { return neighbors_[leaf]; }

  /// The leaf at an origin, by bisection.
  std::optional<uint32_t> findLeaf(const Coord& origin) const;
  /// The object voxel at a place, by bisection.
  std::optional<VoxelId> findVoxel(const Coord& p) const;

  /// Object voxels before a leaf, and in it.
  size_t firstRank(size_t leaf) const { return firstRank_[leaf]; }
  size_t leafVoxels(size_t leaf) const { return firstRank_[leaf + 1] - firstRank_[leaf]; }
  /// Object voxels before a voxel: where a VoxelArray holds its value.
  size_t rank(VoxelId id) const {
    const size_t leaf = leafOf(id), x = wordOf(id);
    const uint64_t before = masks_[leaf][x] & ((uint64_t(1) << bitOf(id)) - 1);
    return firstRank_[leaf] + wordRank_[leaf][x] + detail::countBits(before);
  }

  Coord coord(VoxelId id) const {
    const Coord& o = origins_[leafOf(id)];
    return {o.x() + int(wordOf(id)), o.y() + int(bitOf(id) >> 3), o.z() + int(bitOf(id) & 7)};
  }

 private:
  /// Counts the voxels of origins_ and masks_, and links the leaves.
  void finish();

  std::vector<Coord> origins_;  // of the leaves, then of foreign ones
  std::vector<Mask> masks_;
  std::vector<Neighbors> neighbors_;
  std::vector<uint32_t> firstRank_{0};             // one more at the end
  std::vector<std::array<uint16_t, 8>> wordRank_;  // object voxels of the leaf before each word
  CoordBBox boundingBox_;
};

/// The order of leaves by their origins: x, then y, then z.
struct ByOrigin {
  template <typename Leaf>
  bool operator()(const Leaf& a, const Leaf& b) const {
    return a.origin < b.origin;
  }
  template <typename Leaf>
  bool operator()(const Leaf& leaf, const Coord& origin) const {
    return leaf.origin < origin;
  }
};

}  // namespace vdb_madf
