// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/clumps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/detail/world_transform.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/detail/metric.h"
#include "vdb_madf/shapes/detail/balls_apart.h"
#include "vdb_madf/shapes/detail/bit_box.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using detail::BallRows;
using detail::BitBox;
using openvdb::Index;

int64_t gain(BitBox& uncovered, const Clump::Ball& ball, const BallRows& rows) {
  if (!rows.masks.empty()) return uncovered.count(ball, rows);
  int64_t sum = 0;
  uncovered.forEachWord(ball, [&](uint64_t word, uint64_t mask, const Coord&) {
    sum += detail::countBits(word & mask);
  });
  return sum;
}

void cover(BitBox& uncovered, const Clump::Ball& ball) {
  uncovered.forEachWord(ball, [](uint64_t& word, uint64_t mask, const Coord&) { word &= ~mask; });
}

/// What a ball would cover when it was last asked: it can only have become less.
struct Candidate {
  int64_t gain;
  Clump::Ball ball;
  bool operator<(const Candidate& o) const {
    if (gain != o.gain) return gain < o.gain;
    if (ball.squaredRadius != o.ball.squaredRadius)
      return ball.squaredRadius < o.ball.squaredRadius;
    return o.ball.center < ball.center;
  }
};

CoordBBox boxOf(const std::vector<Clump::Ball>& balls, const VoxelWeights& weights) {
  CoordBBox box;
  for (const Clump::Ball& ball : balls) {
    Coord reach;
    for (int axis = 0; axis < 3; ++axis)
      reach[axis] = int(std::sqrt(ball.squaredRadius / weights[axis]));
    box.expand(CoordBBox(ball.center - reach, ball.center + reach));
  }
  return box;
}

/// Lazy greedy cover (Minoux 1978). At first a ball is thought to cover all its voxels: the
/// smallest ones are never asked.
void chooseBalls(const std::vector<Clump::Ball>& balls, const ClumpOptions& options,
                 detail::BallRowsCache& rows, BitBox& uncovered, Clump& clump) {
  clump.uncovered = clump.voxels;
  std::vector<Candidate> candidates;
  for (const Clump::Ball& ball : balls)
    candidates.push_back({rows.of(ball.squaredRadius).voxels, ball});
  std::priority_queue<Candidate> queue(std::less<Candidate>(), std::move(candidates));
  const double enough = options.coverageError * double(clump.voxels);
  while (!queue.empty() && int(clump.balls.size()) < options.mostBalls &&
         double(clump.uncovered) > enough) {
    Candidate best = queue.top();
    queue.pop();
    const int64_t now = gain(uncovered, best.ball, rows.of(best.ball.squaredRadius));
    if (now == 0) continue;
    if (now < best.gain) {
      best.gain = now;
      queue.push(best);
      continue;
    }
    cover(uncovered, best.ball);
    clump.balls.push_back(best.ball);
    clump.uncovered -= now;
  }
}

double distanceTo(const std::vector<Clump::Ball>& balls, const Coord& p,
                  const VoxelWeights& weights) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Clump::Ball& ball : balls)
    nearest = std::min(nearest, std::sqrt(double(detail::squaredBetween(p, ball.center, weights))) -
                                    std::sqrt(ball.squaredRadius));
  return std::max(nearest, 0.0);
}

/// The figures of a clump, from its balls and the voxels that they leave.
void measure(const BitBox& uncovered, const VoxelWeights& weights, Clump& clump) {
  clump.uncovered = uncovered.count();
  if (clump.balls.empty()) return;
  BitBox all(boxOf(clump.balls, weights), weights);
  for (const Clump::Ball& ball : clump.balls)
    all.forEachWord(ball, [](uint64_t& word, uint64_t mask, const Coord&) { word |= mask; });
  clump.outside = all.count() - (clump.voxels - clump.uncovered);
  uncovered.forEachSet([&](const Coord& p) {
    clump.farthest = std::max(clump.farthest, distanceTo(clump.balls, p, weights));
  });
}

/// Boxes and balls of all grains, from one pass over the leaves.
struct Grains {
  std::vector<CoordBBox> boxes;
  std::vector<std::vector<Clump::Ball>> balls;
};

/// The label nearest to a ball's center, within the ball and kMaxReach (tie: the smaller
/// coordinate); 0: none. In cubes of growing size.
int32_t nearestLabel(const openvdb::tree::ValueAccessor<const Int32Tree>& labels,
                     const Clump::Ball& ball, const VoxelWeights& weights) {
  constexpr int kMaxReach = 16;  // a cavity is small
  int32_t label = 0;
  Coord where;
  int64_t nearest = int64_t(ball.squaredRadius);
  for (int reach = 1;
       reach <= kMaxReach && detail::squaredAlong(int64_t(reach), weights.least()) <= nearest;
       ++reach) {
    CoordBBox cube(ball.center, ball.center);
    cube.expand(reach);
    for (auto p = cube.begin(); p; ++p) {
      const Coord away = *p - ball.center;
      if (std::max({std::abs(away.x()), std::abs(away.y()), std::abs(away.z())}) != reach) continue;
      const int64_t square = detail::squaredBetween(*p, ball.center, weights);
      int32_t value = 0;
      const bool isFarther = square > nearest || (square == nearest && (!label || where < *p));
      if (isFarther || !labels.probeValue(*p, value) || value <= 0) continue;
      nearest = square;
      where = *p;
      label = value;
    }
  }
  return label;
}

/// Gives the balls whose center has no label, in filled cavities, to the grain around it.
void collectCavityBalls(const Int32Tree& labels, const Int32Tree& balls,
                        const VoxelWeights& weights, const detail::LabelBlocks& blocks,
                        Grains& grains) {
  const openvdb::tree::ValueAccessor<const Int32Tree> labelAt(labels);
  for (auto ball = balls.cbeginValueOn(); ball; ++ball) {
    int32_t here = 0;
    if (*ball <= 0 || (labelAt.probeValue(ball.getCoord(), here) && here > 0)) continue;
    const Clump::Ball own{ball.getCoord(), double(*ball)};
    if (const int32_t label = nearestLabel(labelAt, own, weights))
      grains.balls[blocks.number(label)].push_back(own);
  }
}

Grains collect(const Int32Tree& labels, const Int32Tree& balls, const VoxelWeights& weights,
               const detail::LabelBlocks& blocks) {
  Grains grains{std::vector<CoordBBox>(blocks.labels().size()),
                std::vector<std::vector<Clump::Ball>>(blocks.labels().size())};
  for (auto leaf = labels.cbeginLeaf(); leaf; ++leaf) {
    const int32_t* values = leaf->buffer().data();
    const Leaf* ballLeaf = balls.probeConstLeaf(leaf->origin());
    int32_t label = 0;
    uint32_t grain = 0;
    for (Index i = 0; i < Leaf::SIZE; ++i) {
      const int32_t here = detail::labelAt(*leaf, values, i);
      if (!here) continue;
      if (here != label) grain = blocks.number(label = here);
      const Coord p = leaf->offsetToGlobalCoord(i);
      grains.boxes[grain].expand(p);
      if (ballLeaf && ballLeaf->isValueOn(i) && ballLeaf->getValue(i) > 0)
        grains.balls[grain].push_back({p, double(ballLeaf->getValue(i))});
    }
  }
  collectCavityBalls(labels, balls, weights, blocks, grains);
  return grains;
}

/// The voxels of a box whose label (0: none) is wanted.
template <typename Wanted>
BitBox voxelsOf(const Int32Tree& labels, const CoordBBox& box, const VoxelWeights& weights,
                const Wanted& wanted) {
  BitBox bits(box, weights);
  detail::forEachLeafOrigin(box, [&](const Coord& origin) {
    const Leaf* leaf = labels.probeConstLeaf(origin);
    if (!leaf) return;
    const int32_t* values = leaf->buffer().data();
    for (Index i = 0; i < Leaf::SIZE; ++i)
      if (wanted(detail::labelAt(*leaf, values, i))) {
        const Coord p = leaf->offsetToGlobalCoord(i);
        if (box.isInside(p)) bits.set(p);
      }
  });
  return bits;
}

BitBox voxelsOfGrain(const Int32Tree& labels, int32_t label, const CoordBBox& box,
                     const VoxelWeights& weights) {
  return voxelsOf(labels, box, weights, [label](int32_t here) { return here == label; });
}

/// Makes balls end at the nearest voxel of another grain.
void endAtOtherGrains(const Int32Tree& labels, const CoordBBox& bounds, int32_t label,
                      const VoxelWeights& weights, std::vector<Clump::Ball>& balls) {
  CoordBBox box = boxOf(balls, weights);
  box.intersect(bounds);
  if (box.empty()) return;
  BitBox others =
      voxelsOf(labels, box, weights, [label](int32_t here) { return here > 0 && here != label; });
  for (Clump::Ball& ball : balls) {
    int64_t nearest = int64_t(ball.squaredRadius);
    others.forEachWord(ball, [&](uint64_t word, uint64_t mask, const Coord& first) {
      BitBox::forEachBit(word & mask, first, [&](const Coord& p) {
        nearest = std::min(nearest, detail::squaredBetween(p, ball.center, weights));
      });
    });
    ball.squaredRadius = double(nearest);
  }
}

/// Converts lengths from the unit of the weights to the shortest edge.
void toShortestEdges(const VoxelWeights& weights, std::vector<Clump>& clumps) {
  const double unit = weights.least();
  for (Clump& clump : clumps) {
    clump.farthest /= std::sqrt(unit);
    for (Clump::Ball& ball : clump.balls) ball.squaredRadius /= unit;
  }
}

/// Lengths are in the unit of the weights.
std::vector<Clump> weightedClumps(const Int32Grid& labels, const Int32Grid& balls,
                                  const VoxelWeights& weights, const ClumpOptions& options,
                                  Interrupter* interrupter) {
  const detail::LabelBlocks blocks(labels);
  const Int32Tree::ConstPtr tree = detail::withoutTiles(labels),
                            ballTree = detail::withoutTiles(balls);
  Grains grains = collect(*tree, *ballTree, weights, blocks);
  CoordBBox bounds;
  for (const CoordBBox& box : grains.boxes) bounds.expand(box);
  std::vector<Clump> result(blocks.labels().size());
  detail::PerThread<detail::BallRowsCache> rows(weights);
  detail::WorkPart choosing(interrupter, 0, options.apart ? 80 : 100);
  detail::parallelForEach(result.size(), 1, &choosing, [&](size_t g) {
    Clump& clump = result[g];
    clump.label = blocks.labels()[g];
    clump.voxels = blocks.voxelCounts()[g];
    if (options.apart) endAtOtherGrains(*tree, bounds, clump.label, weights, grains.balls[g]);
    BitBox uncovered = voxelsOfGrain(*tree, clump.label, grains.boxes[g], weights);
    chooseBalls(grains.balls[g], options, rows.local(), uncovered, clump);
    if (!options.apart) measure(uncovered, weights, clump);
  });
  if (!options.apart) return result;
  detail::WorkPart shortening(interrupter, 80, 90), measuring(interrupter, 90, 100);
  detail::keepBallsApart(result, weights, &shortening);
  detail::parallelForEach(result.size(), 1, &measuring, [&](size_t g) {
    BitBox uncovered = voxelsOfGrain(*tree, result[g].label, grains.boxes[g], weights);
    for (const Clump::Ball& ball : result[g].balls) cover(uncovered, ball);
    measure(uncovered, weights, result[g]);
  });
  return result;
}

}  // namespace

bool areBallsOfVoxels(const Int32Grid& labels, const Int32Grid& balls) {
  constexpr double kTolerance = 0.011;  // weights are right to 1 %
  const VoxelWeights weights = storedWeights(balls);
  const openvdb::Vec3d edges = detail::proportions(labels.transform());
  for (int axis = 0; axis < 3; ++axis) {
    const double wanted = edges[axis] * edges[axis] * weights.least();
    if (!(std::abs(weights[axis] - wanted) <= kTolerance * wanted)) return false;
  }
  return true;
}

std::vector<Clump> clumps(const Int32Grid& labels, const Int32Grid& balls,
                          const ClumpOptions& options, Interrupter* interrupter) {
  if (options.mostBalls < 1) throw InvalidInput("a clump needs at least one ball");
  if (!(options.coverageError >= 0 && options.coverageError <= 1))
    throw InvalidInput("the part of a grain that may stay uncovered must lie between 0 and 1");
  const VoxelWeights weights = storedWeights(balls);
  if (!areBallsOfVoxels(labels, balls))
    throw InvalidInput("the balls are those of voxels with the weights " + weights.toString() +
                       ", and the grains have other voxels: give balls of these voxels");
  std::vector<Clump> result = weightedClumps(labels, balls, weights, options, interrupter);
  toShortestEdges(weights, result);
  return result;
}

}  // namespace vdb_madf
