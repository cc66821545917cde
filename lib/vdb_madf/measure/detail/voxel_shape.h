// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The box that a voxel is, along the axes of the world. Its shortest edge is the unit of length of
/// all measures.
struct VoxelShape {
  openvdb::Vec3d edges{1, 1, 1};  ///< the shortest is 1

  bool isCube() const { return edges == openvdb::Vec3d(1); }
  double longestEdge() const { return std::max({edges[0], edges[1], edges[2]}); }
  double meanEdge() const { return std::cbrt(volume()); }  ///< of the cube of equal volume
  double volume() const { return edges[0] * edges[1] * edges[2]; }
  /// Area of the face across an axis.
  double faceArea(int axis) const { return edges[(axis + 1) % 3] * edges[(axis + 2) % 3]; }
};

}  // namespace vdb_madf::detail
