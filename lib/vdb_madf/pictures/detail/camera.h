// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/pictures/detail/canvas.h"
#include "vdb_madf/pictures/grain_view.h"

namespace vdb_madf::detail {

/// Where each pixel's ray starts, and how all rays run. Voxel (i, j, k) is here the box from
/// (i, j, k) to (i + 1, j + 1, k + 1), times its edges.
struct Camera {
  using Vec = openvdb::Vec3d;

  Vec right, up, direction;
  Vec low, size;  ///< of the box
  Vec center;
  double voxelsPerPixel = 0;
  int width = 0, height = 0;

  /// @param box not empty
  Camera(const CoordBBox& box, const Vec& edges, const ViewOptions& options);
  /// (x, y) are pixels from the upper left corner of the picture.
  Vec origin(double x, double y) const {
    return center + (x - 0.5 * width) * voxelsPerPixel * right -
           (y - 0.5 * height) * voxelsPerPixel * up;
  }
  Point project(const Vec& p) const {
    return {0.5 * width + right.dot(p - center) / voxelsPerPixel,
            0.5 * height - up.dot(p - center) / voxelsPerPixel};
  }
};

/// The edges of the camera's box that do not lie before it, and the names of the axes beside it.
void drawBox(const Camera& camera, const Rgb& ink, Picture& picture);

}  // namespace vdb_madf::detail
