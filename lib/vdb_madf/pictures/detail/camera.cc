// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/camera.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vdb_madf::detail {

namespace {

constexpr Rgb kEdges{170, 174, 180};
constexpr double kMargin = 1 / 22.0;  ///< of the longer side, around a box that is drawn

double lengthOf(const Point& p) {
  return std::hypot(p[0], p[1]);
}

}  // namespace

Camera::Camera(const CoordBBox& box, const Vec& edges, const ViewOptions& options) {
  const double a = options.azimuth * M_PI / 180, e = options.elevation * M_PI / 180;
  const Vec towards(std::cos(e) * std::sin(a), -std::cos(e) * std::cos(a), std::sin(e));
  right = Vec(std::cos(a), std::sin(a), 0);
  up = towards.cross(right);
  direction = -towards;
  low = edges * box.min().asVec3d();
  size = edges * box.extents().asVec3d();
  center = low + 0.5 * size;
  double across = 0, high = 0;
  for (int axis = 0; axis < 3; ++axis) {
    across += std::abs(right[axis]) * size[axis];
    high += std::abs(up[axis]) * size[axis];
  }
  if (options.turns) {
    across = std::hypot(size[0], size[1]);
    high = std::abs(std::sin(e)) * across + std::abs(std::cos(e)) * size[2];
  }
  const int least = std::min(13, options.edge / 6);  // for letters that can be read
  const int margin = options.box ? std::max(int(options.edge * kMargin), least) : 0;
  const int edge = options.edge - 2 * margin;
  voxelsPerPixel = std::max(across, high) / edge;
  width = std::clamp(int(std::ceil(across / voxelsPerPixel)), 1, edge) + 2 * margin;
  height = std::clamp(int(std::ceil(high / voxelsPerPixel)), 1, edge) + 2 * margin;
}

void drawBox(const Camera& camera, const Rgb& ink, Picture& picture) {
  const double edge = std::sqrt(double(camera.width) * camera.height);
  const Pen pen{kEdges, std::max(1.0, edge / 700)};
  const double textSize = std::max(10.0, edge / 30);
  paint(picture, 0, 0, picture.width, picture.height, [&](Canvas& canvas) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      std::array<Point, 2> outermost{};  // the lowest or leftmost edge along the axis
      double out = -1e300;
      for (int corner = 0; corner < 4; ++corner) {
        openvdb::Vec3d begin = camera.low;
        begin[u] += corner & 1 ? camera.size[u] : 0;
        begin[v] += corner & 2 ? camera.size[v] : 0;
        openvdb::Vec3d end = begin;
        end[axis] += camera.size[axis];
        const Point a = camera.project(begin), b = camera.project(end);
        // An edge is hidden behind the grains, or lies before them if both of its faces do.
        const bool before = (camera.direction[u] > 0) == !(corner & 1) &&
                            (camera.direction[v] > 0) == !(corner & 2);
        if (!before) canvas.line({a, b}, pen);
        const double below = axis == 2 ? -(a[0] + b[0]) : a[1] + b[1];
        if (below > out) {
          out = below;
          outermost = {a, b};
        }
      }
      const auto& [a, b] = outermost;
      const Point along{b[0] - a[0], b[1] - a[1]};
      const double length = lengthOf(along);
      if (length < 3 * textSize) continue;
      // The name in the middle, off the box; an arrow beside it points to larger numbers.
      const Point middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
      Point away{-along[1] / length, along[0] / length};
      const double outwards =
          away[0] * (middle[0] - 0.5 * camera.width) + away[1] * (middle[1] - 0.5 * camera.height);
      if (outwards < 0) away = {-away[0], -away[1]};
      const auto at = [&](double forward, double off) {
        return Point{middle[0] + (forward * along[0] / length + off * away[0]) * textSize,
                     middle[1] + (forward * along[1] / length + off * away[1]) * textSize};
      };
      const Point name = at(-0.4, 0.75);
      canvas.text({name[0], name[1] + 0.27 * textSize}, std::string(1, "xyz"[axis]), textSize, ink,
                  Anchor::middle);
      const Pen arrow{ink, std::max(1.0, textSize / 14)};
      canvas.line({at(0.1, 0.75), at(1.0, 0.75)}, arrow);
      canvas.line({at(0.72, 0.9), at(1.0, 0.75), at(0.72, 0.6)}, arrow);
    }
  });
}

}  // namespace vdb_madf::detail
