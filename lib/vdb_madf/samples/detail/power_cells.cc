// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/power_cells.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>

#include "vdb_madf/base/detail/parallel.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

/// Edge of the regions whose candidate balls are listed once for all their leaves.
constexpr int kRegionEdge = 64;
constexpr size_t kLeafGrain = 64;

/// Far above the rounding of squared distances (2e9 * 2^-52) and far below a voxel.
constexpr double kSlack = 1e-3;

struct PowerRange {
  double least, greatest;
};

/// Of the ball's power over the voxels of a cube.
PowerRange powerRange(const Ball& ball, const Coord& lower, int edge) {
  const double center[3] = {ball.x, ball.y, ball.z};
  double nearest = 0, farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = center[axis] - lower[axis];
    const double above = lower[axis] + edge - 1 - center[axis];
    const double outside = std::max({0.0, -below, above < 0 ? -above : 0.0});
    const double reach = std::max(below, above);
    nearest += outside * outside;
    farthest += reach * reach;
  }
  const double square = ball.radius * ball.radius;
  return {nearest - square, farthest - square};
}

/// Those of the numbered balls that may have the least power somewhere in the cube, in order.
std::vector<int32_t> candidates(const std::vector<Ball>& balls, const std::vector<int32_t>& among,
                                const Coord& lower, int edge) {
  double bound = std::numeric_limits<double>::infinity();
  for (const int32_t i : among) bound = std::min(bound, powerRange(balls[i], lower, edge).greatest);
  std::vector<int32_t> result;
  for (const int32_t i : among)
    if (powerRange(balls[i], lower, edge).least <= bound + kSlack) result.push_back(i);
  return result;
}

void labelLeaf(Leaf& leaf, const std::vector<Ball>& balls, const std::vector<int32_t>& near) {
  int32_t* labels = leaf.buffer().data();
  for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
    const Coord p = voxel.getCoord();
    double best = std::numeric_limits<double>::infinity();
    for (const int32_t i : near) {
      const Ball& ball = balls[i];
      const double dx = p.x() - ball.x, dy = p.y() - ball.y, dz = p.z() - ball.z;
      const double power = dx * dx + dy * dy + dz * dz - ball.radius * ball.radius;
      if (power < best) {
        best = power;
        labels[voxel.pos()] = i + 1;
      }
    }
  }
}

/// Closes the gaps that balls without a voxel leave in the numbers.
void numberOwners(const std::vector<Leaf*>& leaves, size_t ballCount, Interrupter* interrupter) {
  std::vector<std::atomic<bool>> owns(ballCount + 1);
  parallelFor(leaves.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel)
        owns[size_t(*voxel)].store(true, std::memory_order_relaxed);
  });
  std::vector<int32_t> number(ballCount + 1);
  for (size_t i = 1; i <= ballCount; ++i) number[i] = number[i - 1] + int32_t(owns[i]);
  if (number[ballCount] == int32_t(ballCount)) return;
  parallelFor(leaves.size(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (auto voxel = leaves[i]->beginValueOn(); voxel; ++voxel)
        voxel.setValue(number[size_t(*voxel)]);
  });
}

}  // namespace

Int32Tree::Ptr powerCells(const MaskTree& object, const std::vector<Ball>& balls,
                          Interrupter* interrupter) {
  auto labels = std::make_shared<Int32Tree>(object, 0, openvdb::TopologyCopy());
  std::vector<Leaf*> leaves;
  labels->getNodes(leaves);

  std::map<Coord, std::vector<Leaf*>> regions;
  for (Leaf* leaf : leaves) regions[leaf->origin() & ~(kRegionEdge - 1)].push_back(leaf);
  std::vector<std::pair<Coord, std::vector<Leaf*>>> work(regions.begin(), regions.end());

  std::vector<int32_t> all(balls.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = int32_t(i);
  parallelFor(work.size(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto inRegion = candidates(balls, all, work[i].first, kRegionEdge);
      for (Leaf* leaf : work[i].second)
        labelLeaf(*leaf, balls, candidates(balls, inRegion, leaf->origin(), int(Leaf::DIM)));
    }
  });
  numberOwners(leaves, balls.size(), interrupter);
  return labels;
}

}  // namespace vdb_madf::detail
