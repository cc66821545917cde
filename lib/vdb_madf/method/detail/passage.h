// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

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
/// They do so within the box of the region, at least as far away from the object, along each axis, as
/// is needed.
class Passage {
 public:
  /// For distances: `reach` voxels. So a squared distance D is exact if D <= w reach^2, w the least
  /// weight; a larger one may be too large.
  Passage(const LeafIndex& object, const Domain& region, int reach, const VoxelWeights& weights);
  /// For powers: around each voxel the radius of its ball.
  Passage(const LeafIndex& object, const Domain& region, const VoxelArray<int32_t>& squaredRadii,
          const VoxelWeights& weights);

  /// Of the object and those unknown voxels, in leaves of 8 voxels as always: a voxel of one of its
  /// leaves that is none of them is background.
  const LeafIndex& index() const { return index_; }
  /// The largest D that is exact, of distances; kInfinite (distance_rows.h) if all are.
  uint32_t exactUpTo() const { return exactUpTo_; }

  /// Values of the object's voxels as an array of this index, `unknown` for the other voxels.
  VoxelArray<int32_t> spread(const LeafIndex& object, const VoxelArray<int32_t>& values,
                             int32_t unknown) const;
  /// The way back.
  void collect(const LeafIndex& object, const VoxelArray<int32_t>& values,
               VoxelArray<int32_t>& ofObject) const;
  /// The same of ids of voxels of the object in this index; they become ids of the object's.
  void collectIds(const LeafIndex& object, const VoxelArray<VoxelId>& ids,
                  VoxelArray<VoxelId>& ofObject) const;

 private:
  void linkLeaves(const LeafIndex& object);

  LeafIndex index_;
  uint32_t exactUpTo_ = 0;
  std::vector<uint32_t> leafHere_;      // of a leaf of the object
  std::vector<uint32_t> leafOfObject_;  // of a leaf here; kNone
};

}  // namespace vdb_madf::detail
