// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The grid's tree, or a copy of it without tiles if it has active ones.
Int32Tree::ConstPtr withoutTiles(const Int32Grid& labels);

/// The label of a voxel of a leaf: its value if it is active and that is positive, else 0.
inline int32_t labelAt(const Int32Tree::LeafNodeType& leaf, const int32_t* values,
                       openvdb::Index offset) {
  return leaf.isValueOn(offset) && values[offset] > 0 ? values[offset] : 0;
}

/// Labels of an 8x8x8 block with one voxel more on each side: -1 to 8 along x, y and z; 0: none.
using LabelHalo = std::array<int32_t, 1000>;
/// Steps from a voxel of it to the next along x, y and z.
constexpr int kHaloStride[3] = {100, 10, 1};
inline size_t haloAt(int x, int y, int z) {
  return size_t((x + 1) * kHaloStride[0] + (y + 1) * kHaloStride[1] + (z + 1) * kHaloStride[2]);
}
/// Reads the block at an origin; tiles are read as the voxels that they stand for.
void readLabelHalo(const Int32Tree& tree, const Coord& origin, LabelHalo& halo);

/// The 8x8x8 blocks that own a corner of a labeled voxel, sorted by origin (x, then y, then z).
///
/// Corner p of the voxel lattice is the point p - 1/2, shared by the voxels p - 1 to p; it belongs
/// to the block of voxel p, which may itself hold no label.
class LabelBlocks {
 public:
  static constexpr size_t kNone = ~size_t(0);

  explicit LabelBlocks(const Int32Grid& labels);

  size_t size() const { return origins_.size(); }
  const Coord& origin(size_t block) const { return origins_[block]; }
  size_t find(const Coord& origin) const;  ///< kNone if it is no block
  void readHalo(size_t block, LabelHalo& halo) const {
    readLabelHalo(*tree_, origins_[block], halo);
  }

  /// Ascending.
  const std::vector<int32_t>& labels() const { return labels_; }
  const std::vector<int64_t>& voxelCounts() const { return voxelCounts_; }  ///< of labels()
  /// Position in labels() of one of them.
  uint32_t number(int32_t label) const;

 private:
  Int32Tree::ConstPtr tree_;
  std::vector<Coord> origins_;
  std::vector<int32_t> labels_;
  std::vector<int64_t> voxelCounts_;
};

}  // namespace vdb_madf::detail
