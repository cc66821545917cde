// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_madf/samples/detail/ball_union.h"

namespace vdb_madf::detail {

/// A BallUnion that keeps its balls alone, and draws them slab by slab along z.
class BallSlabs {
 public:
  static constexpr int kHeight = MaskBlocks::kEdge;

  BallSlabs(const Coord& size, const Lattice& lattice);

  int64_t countNew(const Ball& ball) const;
  void add(const Ball& ball);
  /// Draws all slabs, to count their voxels. @throw Interrupted
  void add(const std::vector<Ball>& balls, Interrupter* interrupter);
  int64_t voxelCount() const { return voxelCount_; }

  size_t slabCount() const { return ballsOf_.size(); }
  /// The voxels kHeight * slab <= z < kHeight * (slab + 1). @throw Interrupted
  MaskTree::Ptr slab(size_t slab, Interrupter* interrupter) const;

 private:
  void keep(const Ball& ball);
  /// The slabs that it may have voxels in; it meets the box.
  std::pair<size_t, size_t> slabsOf(const CoordBBox& ball) const;
  /// What there is in the blocks that meet a box.
  BallUnion draw(const CoordBBox& box, Interrupter* interrupter) const;
  BallUnion drawSlab(size_t slab, Interrupter* interrupter) const;

  Coord size_;
  Lattice lattice_;
  std::vector<Ball> balls_;
  std::vector<std::vector<uint32_t>> ballsOf_;  // of each slab
  int64_t voxelCount_ = 0;
};

}  // namespace vdb_madf::detail
