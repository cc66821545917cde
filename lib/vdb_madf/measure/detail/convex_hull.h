// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The convex hull of points in space.
struct ConvexHull {
  /// A side of a facet where its plane meets another one.
  struct Edge {
    std::array<uint32_t, 2> ends;           ///< positions in `vertices`
    std::array<openvdb::Vec3d, 2> normals;  ///< of the two facets; outwards, unit vectors
  };
  std::vector<openvdb::Vec3d> vertices;  ///< all corners, perhaps with points on the faces
  std::vector<Edge> edges;
  double volume = 0, area = 0;
};

/// By qhull (Barber, Dobkin & Huhdanpaa 1996); the same points in the same order give the same
/// bits.
/// @param points at least four, not all in a plane
ConvexHull convexHull(const std::vector<openvdb::Vec3d>& points);

/// The largest distance of two vertices.
double diameter(const ConvexHull& hull);

/// The least distance of two parallel planes that enclose the hull. It is found where one plane
/// holds a facet, or each of the two an edge: the planes are turned about each edge, from one of
/// its facets to the other. Time: edges times vertices.
double leastWidth(const ConvexHull& hull);

}  // namespace vdb_madf::detail
