// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <vector>

#include "vdb_madf/samples/detail/ball_union.h"

/// Balls and their power cells by the definitions, voxel by voxel.
namespace vdb_madf::brute {

inline double power(const detail::Ball& ball, const Coord& p) {
  const double dx = p.x() - ball.x, dy = p.y() - ball.y, dz = p.z() - ball.z;
  return dx * dx + dy * dy + dz * dz - ball.radius * ball.radius;
}

/// 1-based number of the ball of least power.
inline int32_t nearest(const std::vector<detail::Ball>& balls, const Coord& p) {
  int32_t best = 0;
  for (size_t i = 1; i < balls.size(); ++i)
    if (power(balls[i], p) < power(balls[size_t(best)], p)) best = int32_t(i);
  return best + 1;
}

inline bool inUnion(const std::vector<detail::Ball>& balls, const Coord& p) {
  return std::any_of(balls.begin(), balls.end(),
                     [&](const detail::Ball& b) { return power(b, p) < 0; });
}

}  // namespace vdb_madf::brute
