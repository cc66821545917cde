// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/balls.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/samples/detail/ball_sample.h"
#include "vdb_madf/samples/detail/sample_options.h"

namespace vdb_madf {

namespace {

using detail::Ball;
using detail::shortestDecimal;

/// A bounding box that exceeds whole voxels by less is as large as these.
constexpr double kBoxTolerance = 1e-6;

ListedBall parseBall(const std::string& line, bool numbered) {
  const char* form = numbered ? "n x y z or n x y z r" : "x y z or x y z r";
  std::string text = line;
  std::replace(text.begin(), text.end(), ',', ' ');
  const auto numbers = detail::reals(text);
  if (!numbers)
    throw InvalidInput(
        fmt::format("{} is not all numbers: write {}", detail::inQuotes(line), form));
  const size_t first = numbered ? 1 : 0;
  if (numbers->size() != first + 3 && numbers->size() != first + 4)
    throw InvalidInput(fmt::format("has {} numbers: write {}", numbers->size(), form));
  for (const double number : *numbers)
    if (!std::isfinite(number))
      throw InvalidInput(detail::inQuotes(line) + " has a number that is not finite");
  const double* values = numbers->data() + first;
  ListedBall ball{values[0], values[1], values[2]};
  if (numbers->size() == first + 4) ball.radius = values[3];
  if (!(ball.radius > 0))
    throw InvalidInput(fmt::format(
        "the radius must be above 0, not {}{}", shortestDecimal(ball.radius),
        numbered ? "" : ": if the lines are n x y z, numbers of balls first, say --numbered"));
  return ball;
}

/// The balls that may meet the box of a size, in its unit of length.
std::vector<Ball> ballsIn(const Coord& size, const BallOptions& options,
                          const openvdb::Vec3d& middle) {
  std::vector<Ball> balls;
  for (const ListedBall& listed : options.balls) {
    const openvdb::Vec3d place(listed.x, listed.y, listed.z);
    const double radius = listed.radius * options.radius;
    openvdb::Vec3d center;
    bool meets = true;
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = (place[axis] - middle[axis]) * options.radius + (size[axis] - 1) / 2.0;
      meets &= center[axis] > -1 - radius && center[axis] < size[axis] + radius;
    }
    if (meets) balls.push_back({center.x(), center.y(), center.z(), radius});
  }
  return balls;
}

struct Bounds {
  openvdb::Vec3d lower{std::numeric_limits<double>::infinity()};
  openvdb::Vec3d upper{-std::numeric_limits<double>::infinity()};
};

Bounds boundsOf(const std::vector<ListedBall>& balls) {
  Bounds bounds;
  for (const ListedBall& ball : balls) {
    const openvdb::Vec3d center(ball.x, ball.y, ball.z), reach(ball.radius);
    bounds.lower = openvdb::math::minComponent(bounds.lower, center - reach);
    bounds.upper = openvdb::math::maxComponent(bounds.upper, center + reach);
  }
  return bounds;
}

Coord sizeOf(const Bounds& bounds, double scale) {
  Coord size;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = (bounds.upper[axis] - bounds.lower[axis]) * scale;
    if (!(extent <= kMaxExtent))
      throw InvalidInput(fmt::format(
          "the balls take {} voxels along {}, and at most {} can be: use a smaller radius, or cut "
          "out a size",
          shortestDecimal(std::ceil(extent)), "xyz"[axis], kMaxExtent));
    size[axis] = std::max(1, int(std::ceil(extent - kBoxTolerance)));
  }
  return size;
}

void checkBallRadii(const BallOptions& options) {
  if (!(options.radius > 0 && std::isfinite(options.radius)))
    throw InvalidInput("radius must be above 0, not " + shortestDecimal(options.radius));
  if (options.balls.empty()) throw InvalidInput("there are no balls");
  for (size_t i = 0; i < options.balls.size(); ++i)
    detail::checkRange(fmt::format("radius of ball {} in voxels", i + 1).c_str(),
                       options.balls[i].radius * options.radius, detail::kMinRadius, kMaxExtent);
}

}  // namespace

std::vector<ListedBall> parseBalls(const std::string& text, bool numbered) {
  std::vector<ListedBall> balls;
  std::istringstream stream(text);
  size_t number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    line = detail::trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    try {
      balls.push_back(parseBall(line, numbered));
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("line {}: {}", number, error.what()));
    }
  }
  if (balls.empty()) throw InvalidInput("there is no ball in it: write a line x y z for each");
  return balls;
}

Sample generateBalls(const BallOptions& options, Interrupter* interrupter) {
  checkBallRadii(options);
  const Bounds bounds = boundsOf(options.balls);
  const Coord size = options.size ? *options.size : sizeOf(bounds, options.radius);
  detail::checkSize(size);

  const detail::Lattice lattice(options.voxelSize);
  const Coord voxels = lattice.voxels(size);
  const std::vector<Ball> balls = ballsIn(size, options, bounds.lower / 2.0 + bounds.upper / 2.0);
  detail::SourceText source("balls " + options.list);
  source.size(size).add("radius", options.radius).edges(options.voxelSize);
  return detail::described(detail::ballSample(balls, voxels, lattice, interrupter), voxels, source,
                           options.voxelSize);
}

}  // namespace vdb_madf
