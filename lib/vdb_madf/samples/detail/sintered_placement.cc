// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/placement.h"

#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/samples/detail/random.h"

namespace vdb_madf::detail {

namespace {

/// Random positions tried for a ball before the box counts as full.
constexpr int kMaxSinteredTries = 50000;
constexpr int kSinteredPollInterval = 256;

/// Stream 1 is the noise.
constexpr uint64_t kSinteredBallStream = 0;

bool keepsDistance(const Ball& ball, const std::vector<Ball>& others, double neck) {
  for (const Ball& other : others) {
    const double dx = ball.x - other.x, dy = ball.y - other.y, dz = ball.z - other.z;
    const double distance = neck * (ball.radius + other.radius);
    if (dx * dx + dy * dy + dz * dz < distance * distance) return false;
  }
  return true;
}

}  // namespace

/// Random sequential addition: each ball keeps its radius and tries positions until one fits.
std::vector<Ball> placeSintered(const SinteredOptions& options, Interrupter* interrupter) {
  RandomSequence random(options.seed, kSinteredBallStream);
  std::vector<Ball> balls;
  while (int(balls.size()) < options.count) {
    Ball ball;
    ball.radius = random.uniform(options.minRadius, options.maxRadius);
    int tries = 0;
    do {
      if (tries % kSinteredPollInterval == 0 && interrupter && interrupter->wasInterrupted())
        throw Interrupted();
      if (tries++ == kMaxSinteredTries)
        throw InvalidInput("only " + std::to_string(balls.size()) + " of " +
                           std::to_string(options.count) +
                           " balls fit: use a smaller count, radius or neck, or a larger size");
      ball.x = random.uniform(-0.5, options.size.x() - 0.5);
      ball.y = random.uniform(-0.5, options.size.y() - 0.5);
      ball.z = random.uniform(-0.5, options.size.z() - 0.5);
    } while (!keepsDistance(ball, balls, options.neck));
    balls.push_back(ball);
  }
  sortByCenter(balls);
  return balls;
}

}  // namespace vdb_madf::detail
