// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Parallel rays through the voxels of an object. Voxel (i, j, k) is here the box from (i, j, k) to
/// (i + 1, j + 1, k + 1), times its edges.
class VoxelRays {
 public:
  using Vec = openvdb::Vec3d;

  /// @param object without tiles, nothing beyond the box
  VoxelRays(const MaskGrid::ConstPtr& object, const CoordBBox& box, const Vec& edges,
            const Vec& direction);

  const MaskGrid& object() const { return *object_; }

  /// Does the ray from `origin` meet a voxel? The first one, and where it enters it: origin +
  /// t * direction.
  /// @param accessor of the object
  bool first(const MaskGrid::ConstUnsafeAccessor& accessor, const Vec& origin, Coord& voxel,
             double& t) const;

 private:
  const MaskGrid::ConstPtr object_;
  const Vec edges_, leafEdges_, direction_;
  Vec low_, high_;
  Coord leafLow_, leafHigh_;
};

}  // namespace vdb_madf::detail
