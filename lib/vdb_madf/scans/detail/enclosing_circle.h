// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

using PlanePoint = std::array<double, 2>;

struct Circle {
  PlanePoint center{{0, 0}};
  double squaredRadius = -1;  ///< below 0: it holds nothing
  double squaredDistance(const PlanePoint& p) const {
    const double du = p[0] - center[0], dv = p[1] - center[1];
    return du * du + dv * dv;
  }
  bool holds(const PlanePoint& p) const {
    return squaredDistance(p) <= squaredRadius * (1 + 1e-12) + 1e-12;
  }
};

inline Circle circleOf(const PlanePoint& p, const PlanePoint& q) {
  Circle circle{{{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2}}, 0};
  circle.squaredRadius = circle.squaredDistance(p);
  return circle;
}

/// The circle through three points, or through the first two if they are on a line.
inline Circle circleOf(const PlanePoint& p, const PlanePoint& q, const PlanePoint& r) {
  const double ax = q[0] - p[0], ay = q[1] - p[1], bx = r[0] - p[0], by = r[1] - p[1];
  const double twice = 2 * (ax * by - ay * bx);
  if (twice == 0) return circleOf(p, q);
  const double a = ax * ax + ay * ay, b = bx * bx + by * by;
  Circle circle{{{p[0] + (by * a - ay * b) / twice, p[1] + (ax * b - bx * a) / twice}}, 0};
  circle.squaredRadius = circle.squaredDistance(p);
  return circle;
}

/// The smallest circle that holds all points, one by one (Welzl 1991): a point that the circle so
/// far does not hold lies on the next one. In a random order that takes linear time.
inline Circle smallestCircle(std::vector<PlanePoint> points) {
  uint64_t state = 1;
  for (size_t i = points.size(); i > 1; --i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    std::swap(points[i - 1], points[size_t(state >> 33) % i]);
  }
  Circle circle;
  for (size_t i = 0; i < points.size(); ++i) {
    if (circle.holds(points[i])) continue;
    circle = {points[i], 0};
    for (size_t j = 0; j < i; ++j) {
      if (circle.holds(points[j])) continue;
      circle = circleOf(points[i], points[j]);
      for (size_t k = 0; k < j; ++k)
        if (!circle.holds(points[k])) circle = circleOf(points[i], points[j], points[k]);
    }
  }
  return circle;
}

}  // namespace vdb_madf::detail
