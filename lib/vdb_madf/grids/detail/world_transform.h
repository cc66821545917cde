// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The edges of a voxel along the axes of the world, negative where these are mirrored; nothing if
/// voxels are turned or sheared, or differ from place to place.
inline std::optional<openvdb::Vec3d> edgesAlongAxes(const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) return std::nullopt;
  const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0));
  openvdb::Vec3d edges(0);
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Vec3d unit(0);
    unit[axis] = 1;
    openvdb::Vec3d aside = transform.indexToWorld(unit) - origin;
    edges[axis] = aside[axis];
    aside[axis] = 0;
    if (!(aside.length() <= (kMaxEdgeRatio - 1) * std::abs(edges[axis]))) return std::nullopt;
  }
  return edges;
}

/// Equal but for their signs, and none is 0.
inline bool areEdgesOfCube(const openvdb::Vec3d& edges) {
  const auto [min, max] = std::minmax({std::abs(edges[0]), std::abs(edges[1]), std::abs(edges[2])});
  return min > 0 && max <= kMaxEdgeRatio * min;
}

/// World = origin + index * edge.
struct CubicTransform {
  openvdb::Vec3d origin;  ///< of the centre of voxel (0,0,0)
  double edge = 1;
};

/// @throw InvalidInput if voxels are not cubes along the axes of the world, or mirrored.
inline CubicTransform cubicTransform(const openvdb::math::Transform& transform) {
  const auto edges = edgesAlongAxes(transform);
  if (!edges || !areEdgesOfCube(*edges) || !((*edges)[0] > 0 && (*edges)[1] > 0 && (*edges)[2] > 0))
    throw InvalidInput("the grid's voxels are not cubes along the axes: resample the grid first");
  return {transform.indexToWorld(openvdb::Vec3d(0)), (*edges)[0]};
}

}  // namespace vdb_madf::detail
