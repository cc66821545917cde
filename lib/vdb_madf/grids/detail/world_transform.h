// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cmath>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// World = origin + index * edge.
struct CubicTransform {
  openvdb::Vec3d origin;  ///< of the centre of voxel (0,0,0)
  double edge = 1;
};

/// @throw InvalidInput if voxels are not cubes along the axes of the world.
inline CubicTransform cubicTransform(const openvdb::math::Transform& transform) {
  CubicTransform result;
  bool isCubic = transform.isLinear();
  if (isCubic) {
    result.origin = transform.indexToWorld(openvdb::Vec3d(0));
    result.edge = transform.indexToWorld(openvdb::Vec3d(1, 0, 0)).x() - result.origin.x();
    for (int axis = 0; axis < 3; ++axis) {
      openvdb::Vec3d unit(0), wanted(0);
      unit[axis] = 1;
      wanted[axis] = result.edge;
      const openvdb::Vec3d found = transform.indexToWorld(unit) - result.origin;
      isCubic = isCubic && (found - wanted).length() <= (kMaxEdgeRatio - 1) * std::abs(result.edge);
    }
  }
  if (!isCubic || !(result.edge > 0))
    throw InvalidInput("the grid's voxels are not cubes along the axes: resample the grid first");
  return result;
}

}  // namespace vdb_madf::detail
