// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/balls_apart.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf::detail {

namespace {

using openvdb::BBoxd;
using openvdb::Vec3d;

BBoxd boxOf(const Clump& clump, const VoxelWeights& weights) {
  BBoxd box;
  for (const Clump::Ball& ball : clump.balls) {
    const Vec3d center = ball.center.asVec3d();
    Vec3d reach;
    for (int axis = 0; axis < 3; ++axis)
      reach[axis] = std::sqrt(ball.squaredRadius / weights[axis]);
    box.expand(center - reach);
    box.expand(center + reach);
  }
  return box;
}

/// The clumps whose boxes meet that of each clump, from a sweep along x.
std::vector<std::vector<size_t>> neighborsOf(const std::vector<BBoxd>& boxes) {
  std::vector<size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const double left = boxes[a].min().x(), right = boxes[b].min().x();
    return left != right ? left < right : a < b;
  });
  std::vector<std::vector<size_t>> neighbors(boxes.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const BBoxd& box = boxes[order[i]];
    for (size_t j = i + 1; j < order.size() && boxes[order[j]].min().x() < box.max().x(); ++j)
      if (box.hasOverlap(boxes[order[j]])) {
        neighbors[order[i]].push_back(order[j]);
        neighbors[order[j]].push_back(order[i]);
      }
  }
  return neighbors;
}

/// Shortens `radius`, that of a ball, to the planes between it and the balls of another clump.
void shorten(double& radius, const Clump::Ball& ball, const Clump& other,
             const VoxelWeights& weights) {
  const double r = std::sqrt(ball.squaredRadius);
  for (const Clump::Ball& there : other.balls) {
    const double reach = r + std::sqrt(there.squaredRadius),
                 square = double(squaredBetween(there.center, ball.center, weights));
    if (square >= reach * reach) continue;
    const double d = std::sqrt(square);
    radius = std::min(radius, (square + ball.squaredRadius - there.squaredRadius) / (2 * d));
  }
}

}  // namespace

void keepBallsApart(std::vector<Clump>& clumps, const VoxelWeights& weights,
                    Interrupter* interrupter) {
  std::vector<BBoxd> boxes;
  for (const Clump& clump : clumps) boxes.push_back(boxOf(clump, weights));
  const auto neighbors = neighborsOf(boxes);
  std::vector<std::vector<Clump::Ball>> kept(clumps.size());
  parallelForEach(clumps.size(), 1, interrupter, [&](size_t g) {
    for (const Clump::Ball& ball : clumps[g].balls) {
      const double whole = std::sqrt(ball.squaredRadius);
      double radius = whole;
      for (const size_t other : neighbors[g]) shorten(radius, ball, clumps[other], weights);
      if (radius == whole)
        kept[g].push_back(ball);
      else if (radius > 0)
        kept[g].push_back({ball.center, radius * radius});
    }
  });
  for (size_t g = 0; g < clumps.size(); ++g) clumps[g].balls = std::move(kept[g]);
}

}  // namespace vdb_madf::detail
