// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/samples/detail/lattice.h"
#include "vdb_madf/samples/detail/mask_blocks.h"

namespace vdb_madf::detail {

/// The open ball |p - c| < r, in the unit of length of a lattice: the voxel at p is inside if
/// (dx*dx + dy*dy) + dz*dz < r*r in doubles.
struct Ball {
  double x = 0, y = 0, z = 0, radius = 0;
};

/// Sorts balls by center (x, then y, then z): the order in which the true grains are numbered.
void sortByCenter(std::vector<Ball>& balls);

/// Voxels along z; empty if last < first.
struct RowRange {
  int first = 0, last = -1;
};

/// The voxels of row (x, y) inside the ball, cut to [zMin, zMax].
RowRange ballRow(const Ball& ball, int x, int y, int zMin, int zMax, const Lattice& lattice = {});

/// A box that contains the ball's voxels.
CoordBBox ballBox(const Ball& ball, const Lattice& lattice = {});

/// The union of balls in the voxels [0, size - 1], grown ball by ball, with an exact count of its
/// voxels. Memory: the mask leaves on the balls' surfaces; full leaves become tiles if asked for.
class BallUnion {
 public:
  BallUnion(const Coord& size, bool fullLeavesAsTiles, const Lattice& lattice = {})
      : BallUnion(size, fullLeavesAsTiles, lattice, CoordBBox::inf()) {}
  /// Draws the blocks alone that meet `part`.
  BallUnion(const Coord& size, bool fullLeavesAsTiles, const Lattice& lattice,
            const CoordBBox& part)
      : lattice_(lattice), blocks_(size), part_(part), tiles_(fullLeavesAsTiles) {}

  /// The number of voxels that the ball would add.
  int64_t countNew(const Ball& ball) const;
  void add(const Ball& ball);
  /// Parallel over blocks. @throw Interrupted
  void add(const std::vector<Ball>& balls, Interrupter* interrupter);

  int64_t voxelCount() const { return voxelCount_; }
  MaskTree::Ptr takeTree() { return blocks_.takeTree(); }

 private:
  /// Calls visit(block) for each block that the ball's box meets.
  template <typename Visit>
  void visitBlocks(const Ball& ball, const Visit& visit) const;

  Lattice lattice_;
  MaskBlocks blocks_;
  CoordBBox part_;
  bool tiles_;
  int64_t voxelCount_ = 0;
};

}  // namespace vdb_madf::detail
