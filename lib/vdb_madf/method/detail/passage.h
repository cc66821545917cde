// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/voxel_weights.h"

namespace vdb_madf::detail {

/// The object and, around it, the unknown voxels outside an open region: what sweeps pass through.
///
/// A sweep goes from a voxel p of the object to its nearest background voxel q in the region, or
/// from p to the center of a ball that holds it, in up to three straight lines along the axes. All
/// that lies on them lies in the box that p and q span, and nearer to the one than the other is. In
/// a box domain none of it is unknown. In a region some of it may be, so unknown voxels take part
/// in the sweeps: they carry values on, and have none of their own.
///
/// Unknown voxels do so within the box of the region, at least as far away from the object, along
/// each axis, as is needed; and in those passes only after which a line can turn to the object, or
/// come from it.
class Passage {
 public:
  /// Reaches `reach` voxels, for distances (passes along x, y, z). So a squared distance D is exact
  /// if D <= w reach^2, w the least weight; a larger one may be too large.
  Passage(const LeafIndex& object, const Domain& region, int reach, const VoxelWeights& weights);
  /// Reaches as far as its ball around each voxel, for powers (passes along z, y, x).
  Passage(const LeafIndex& object, const Domain& region, const VoxelArray<int32_t>& squaredRadii,
          const VoxelWeights& weights);

  /// The index of the object and those unknown voxels, in leaves of 8 voxels as always: a voxel of
  /// one of its leaves that is none of them is background.
  const LeafIndex& index() const { return index_; }
  /// The largest D that is exact, of distances; kInfinite (distance_rows.h) if all are.
  uint32_t exactUpTo() const { return exactUpTo_; }

  /// Leaves of the object before a leaf of index(); that leaf is the next one if it hasObject().
  uint32_t objectLeavesBefore(size_t leaf) const { return objectLeavesBefore_[leaf]; }
  bool hasObject(size_t leaf) const {
    return objectLeavesBefore_[leaf] != objectLeavesBefore_[leaf + 1];
  }
  /// Does anything depend on what the voxels of a leaf have after a pass (0, 1 or 2)? All leaves of
  /// the object carry values in all passes, and they alone after the last one.
  bool carries(int pass, size_t leaf) const { return carries_[leaf] >> pass & 1; }

 private:
  void linkObject(const LeafIndex& object);
  /// Chooses for passes along these axes. \p fromObject: do all values come from the object?
  void chooseCarriers(const std::array<int, 3>& axes, bool fromObject);

  LeafIndex index_;
  uint32_t exactUpTo_ = 0;
  std::vector<uint32_t> objectLeavesBefore_;  // one more at the end
  std::vector<uint8_t> carries_;              // a bit for each pass
};

}  // namespace vdb_madf::detail
