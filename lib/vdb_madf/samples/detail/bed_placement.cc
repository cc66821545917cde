// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/placement.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/samples/detail/random.h"

namespace vdb_madf::detail {

namespace {

constexpr int kPlaces = 300;
constexpr size_t kMaxBalls = 20000;  // minutes: the time grows with the square of their number
constexpr double kFloor = -0.5;
constexpr uint64_t kBallStream = 0;

/// How high a ball comes to lie that falls at its (x, y).
double restingHeight(const Ball& ball, const std::vector<Ball>& others) {
  double height = kFloor + ball.radius;
  for (const Ball& other : others) {
    const double dx = ball.x - other.x, dy = ball.y - other.y;
    const double apart = kBedContact * (ball.radius + other.radius);
    const double square = apart * apart - (dx * dx + dy * dy);
    if (square > 0) height = std::max(height, other.z + std::sqrt(square));
  }
  return height;
}

}  // namespace

std::vector<Ball> dropBalls(const BedOptions& options, Interrupter* interrupter) {
  RandomSequence random(options.seed, kBallStream);
  const double top = options.size.z() - 0.5;
  std::vector<Ball> balls;
  while (true) {
    if (interrupter && interrupter->wasInterrupted()) throw Interrupted();
    Ball ball, lowest;
    ball.radius = random.uniform(options.minRadius, options.maxRadius);
    for (int place = 0; place < kPlaces; ++place) {
      ball.x = random.uniform(-0.5, options.size.x() - 0.5);
      ball.y = random.uniform(-0.5, options.size.y() - 0.5);
      ball.z = restingHeight(ball, balls);
      if (place == 0 || ball.z < lowest.z) lowest = ball;
    }
    if (lowest.z - lowest.radius > top) return balls;
    if (balls.size() == kMaxBalls)
      throw InvalidInput("more than " + std::to_string(kMaxBalls) +
                         " balls fit: use a larger radius or a smaller size");
    balls.push_back(lowest);
  }
}

}  // namespace vdb_madf::detail
