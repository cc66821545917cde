// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The edges of a voxel along the axes of the world, none 0, negative where these are mirrored;
/// nothing if voxels are turned or sheared, or differ from place to place.
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
    const double edge = std::abs(edges[axis]);
    if (!(edge > 0 && std::isfinite(edge) && aside.length() <= (kMaxEdgeRatio - 1) * edge))
      return std::nullopt;
  }
  return edges;
}

/// "0.5 x 0.5 x 1.2", without signs.
inline std::string timesText(const openvdb::Vec3d& edges) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis)
    text += (axis > 0 ? " x " : "") + shortestDecimal(std::abs(edges[axis]));
  return text;
}

/// Equal but for their signs.
inline bool areEdgesOfCube(const openvdb::Vec3d& edges) {
  return vdb_madf::areEdgesOfCube({std::abs(edges[0]), std::abs(edges[1]), std::abs(edges[2])});
}

/// The edges of a voxel in units of the shortest; 1 for cubes, and for voxels that are not along
/// the axes.
inline openvdb::Vec3d proportions(const openvdb::math::Transform& transform) {
  const auto edges = edgesAlongAxes(transform);
  if (!edges || areEdgesOfCube(*edges)) return openvdb::Vec3d(1);
  const openvdb::Vec3d lengths = openvdb::math::Abs(*edges);
  return lengths / std::min({lengths[0], lengths[1], lengths[2]});
}

/// World = origin + index * edges, along each axis.
struct WorldTransform {
  openvdb::Vec3d origin;  ///< of the center of voxel (0,0,0)
  openvdb::Vec3d edges{1, 1, 1};
  double shortestEdge() const { return std::min({edges[0], edges[1], edges[2]}); }
};

/// @throw InvalidInput if voxels are not along the axes of the world, or mirrored.
inline WorldTransform worldTransform(const openvdb::math::Transform& transform) {
  const auto edges = edgesAlongAxes(transform);
  if (!edges || !((*edges)[0] > 0 && (*edges)[1] > 0 && (*edges)[2] > 0))
    throw InvalidInput("the grid's voxels are not along the axes: resample the grid first");
  WorldTransform world{transform.indexToWorld(openvdb::Vec3d(0)), *edges};
  if (areEdgesOfCube(*edges)) world.edges = openvdb::Vec3d((*edges)[0]);
  return world;
}

}  // namespace vdb_madf::detail
