// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Squared distances of voxel centers from the axis of a cylinder.
struct CylinderAxis {
  int axis = 2;
  std::array<double, 2> center{{0, 0}};

  int u() const { return axis == 0 ? 1 : 0; }  ///< the first coordinate across it
  int v() const { return axis == 2 ? 1 : 2; }

  double squaredDistance(const Coord& p) const {
    const double du = p[u()] - center[0], dv = p[v()] - center[1];
    return du * du + dv * dv;
  }
  /// The least squared distance of the points of a box, the corners included.
  double nearest(const CoordBBox& box) const {
    const double du = std::clamp(center[0], double(box.min()[u()]), double(box.max()[u()])),
                 dv = std::clamp(center[1], double(box.min()[v()]), double(box.max()[v()]));
    return (du - center[0]) * (du - center[0]) + (dv - center[1]) * (dv - center[1]);
  }
  double farthest(const CoordBBox& box) const {
    Coord corner = box.min();
    for (const int across : {u(), v()}) {
      const double middle = across == u() ? center[0] : center[1];
      if (box.max()[across] - middle > middle - box.min()[across])
        corner[across] = box.max()[across];
    }
    return squaredDistance(corner);
  }
};

}  // namespace vdb_madf::detail
