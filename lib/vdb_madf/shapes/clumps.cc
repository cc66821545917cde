// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/clumps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <queue>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/detail/metric.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using openvdb::Index;

/// A bit per voxel of a box, in rows along z.
class BitBox {
 public:
  explicit BitBox(const CoordBBox& box)
      : box_(box),
        wordsPerRow_((size_t(box.dim().z()) + 63) / 64),
        words_(size_t(box.dim().x()) * size_t(box.dim().y()) * wordsPerRow_) {}

  void set(const Coord& p) {
    const size_t z = size_t(p.z() - box_.min().z());
    row(p.x(), p.y())[z / 64] |= uint64_t(1) << (z & 63);
  }
  /// f(word, mask) for the words of a ball; the mask has the bits of the ball.
  template <typename F>
  void forEachWord(const Clump::Ball& ball, const F& f) {
    const int reach = int(std::sqrt(double(ball.squaredRadius - 1)));
    const Coord& c = ball.center;
    for (int x = std::max(c.x() - reach, box_.min().x());
         x <= std::min(c.x() + reach, box_.max().x()); ++x)
      for (int y = std::max(c.y() - reach, box_.min().y());
           y <= std::min(c.y() + reach, box_.max().y()); ++y) {
        const int64_t dx = x - c.x(), dy = y - c.y(),
                      rest = ball.squaredRadius - 1 - dx * dx - dy * dy;
        if (rest < 0) continue;
        const int half = int(std::sqrt(double(rest)));  // exact: rest is below 2^31
        const int low = std::max(c.z() - half, box_.min().z()) - box_.min().z(),
                  high = std::min(c.z() + half, box_.max().z()) - box_.min().z();
        uint64_t* words = row(x, y);
        for (int word = low / 64; low <= high && word <= high / 64; ++word) {
          uint64_t mask = ~uint64_t(0);
          if (word == low / 64) mask &= ~uint64_t(0) << (low & 63);
          if (word == high / 64) mask &= ~uint64_t(0) >> (63 - (high & 63));
          f(words[word], mask);
        }
      }
  }
  int64_t count() const {
    int64_t sum = 0;
    for (const uint64_t word : words_) sum += detail::countBits(word);
    return sum;
  }
  template <typename F>
  void forEachSet(const F& f) const {
    size_t i = 0;
    for (int x = box_.min().x(); x <= box_.max().x(); ++x)
      for (int y = box_.min().y(); y <= box_.max().y(); ++y)
        for (size_t word = 0; word < wordsPerRow_; ++word)
          for (uint64_t bits = words_[i++]; bits; bits &= bits - 1)
            f(Coord(x, y, box_.min().z() + int(word * 64) + __builtin_ctzll(bits)));
  }

 private:
  uint64_t* row(int x, int y) {
    return &words_[(size_t(x - box_.min().x()) * size_t(box_.dim().y()) +
                    size_t(y - box_.min().y())) *
                   wordsPerRow_];
  }

  CoordBBox box_;
  size_t wordsPerRow_;
  std::vector<uint64_t> words_;
};

int64_t gain(BitBox& uncovered, const Clump::Ball& ball) {
  int64_t sum = 0;
  uncovered.forEachWord(
      ball, [&](uint64_t word, uint64_t mask) { sum += detail::countBits(word & mask); });
  return sum;
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

/// Lazy greedy cover (Minoux 1978).
void chooseBalls(const std::vector<Clump::Ball>& balls, const ClumpOptions& options,
                 BitBox& uncovered, Clump& clump) {
  std::priority_queue<Candidate> queue;
  for (const Clump::Ball& ball : balls) queue.push({gain(uncovered, ball), ball});
  const double enough = options.coverageError * double(clump.voxels);
  while (!queue.empty() && int(clump.balls.size()) < options.mostBalls &&
         double(clump.uncovered) > enough) {
    Candidate best = queue.top();
    queue.pop();
    const int64_t now = gain(uncovered, best.ball);
    if (now == 0) continue;
    if (now < best.gain) {
      best.gain = now;
      queue.push(best);
      continue;
    }
    uncovered.forEachWord(best.ball, [](uint64_t& word, uint64_t mask) { word &= ~mask; });
    clump.balls.push_back(best.ball);
    clump.uncovered -= now;
  }
}

double distanceTo(const std::vector<Clump::Ball>& balls, const Coord& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Clump::Ball& ball : balls)
    nearest = std::min(
        nearest, (p - ball.center).asVec3d().length() - std::sqrt(double(ball.squaredRadius)));
  return std::max(nearest, 0.0);
}

void measure(const BitBox& uncovered, Clump& clump) {
  if (clump.balls.empty()) return;
  CoordBBox box;
  for (const Clump::Ball& ball : clump.balls) {
    const int reach = int(std::sqrt(double(ball.squaredRadius)));
    box.expand(CoordBBox(ball.center.offsetBy(-reach), ball.center.offsetBy(reach)));
  }
  BitBox all(box);
  for (const Clump::Ball& ball : clump.balls)
    all.forEachWord(ball, [](uint64_t& word, uint64_t mask) { word |= mask; });
  clump.outside = all.count() - (clump.voxels - clump.uncovered);
  uncovered.forEachSet([&](const Coord& p) {
    clump.farthest = std::max(clump.farthest, distanceTo(clump.balls, p));
  });
}

/// Boxes and balls of all grains, from one pass over the leaves.
struct Grains {
  std::vector<CoordBBox> boxes;
  std::vector<std::vector<Clump::Ball>> balls;
};

/// The label nearest to a ball's center, within the ball and kMaxReach (tie: the smaller coordinate);
/// 0: none. In cubes of growing size.
int32_t nearestLabel(const openvdb::tree::ValueAccessor<const Int32Tree>& labels,
                     const Clump::Ball& ball) {
  constexpr int kMaxReach = 16;  // a cavity is small
  int32_t label = 0;
  int64_t nearest = ball.squaredRadius;
  for (int reach = 1; reach <= kMaxReach && int64_t(reach) * reach < nearest; ++reach) {
    CoordBBox cube(ball.center, ball.center);
    cube.expand(reach);
    for (auto p = cube.begin(); p; ++p) {
      const Coord away = *p - ball.center;
      if (std::max({std::abs(away.x()), std::abs(away.y()), std::abs(away.z())}) != reach) continue;
      const int64_t square = detail::squaredBetween(*p, ball.center);
      int32_t value = 0;
      if (square >= nearest || !labels.probeValue(*p, value) || value <= 0) continue;
      nearest = square;
      label = value;
    }
  }
  return label;
}

/// Gives the balls whose center has no label, in filled cavities, to the grain around it.
void collectCavityBalls(const Int32Tree& labels, const Int32Tree& balls,
                        const detail::LabelBlocks& blocks, Grains& grains) {
  const openvdb::tree::ValueAccessor<const Int32Tree> labelAt(labels);
  for (auto ball = balls.cbeginValueOn(); ball; ++ball) {
    int32_t here = 0;
    if (*ball <= 0 || (labelAt.probeValue(ball.getCoord(), here) && here > 0)) continue;
    const Clump::Ball own{ball.getCoord(), *ball};
    if (const int32_t label = nearestLabel(labelAt, own))
      grains.balls[blocks.number(label)].push_back(own);
  }
}

Grains collect(const Int32Tree& labels, const Int32Tree& balls, const detail::LabelBlocks& blocks) {
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
        grains.balls[grain].push_back({p, ballLeaf->getValue(i)});
    }
  }
  collectCavityBalls(labels, balls, blocks, grains);
  return grains;
}

BitBox voxelsOf(const Int32Tree& labels, int32_t label, const CoordBBox& box) {
  BitBox bits(box);
  const Coord low = box.min() & ~7, high = box.max();
  for (int x = low.x(); x <= high.x(); x += 8)
    for (int y = low.y(); y <= high.y(); y += 8)
      for (int z = low.z(); z <= high.z(); z += 8) {
        const Leaf* leaf = labels.probeConstLeaf(Coord(x, y, z));
        if (!leaf) continue;
        const int32_t* values = leaf->buffer().data();
        for (Index i = 0; i < Leaf::SIZE; ++i)
          if (values[i] == label && leaf->isValueOn(i)) bits.set(leaf->offsetToGlobalCoord(i));
      }
  return bits;
}

}  // namespace

std::vector<Clump> clumps(const Int32Grid& labels, const Int32Grid& balls,
                          const ClumpOptions& options, Interrupter* interrupter) {
  if (options.mostBalls < 1) throw InvalidInput("a clump needs at least one ball");
  if (!(options.coverageError >= 0 && options.coverageError <= 1))
    throw InvalidInput("the part of a grain that may stay uncovered must lie between 0 and 1");
  const detail::LabelBlocks blocks(labels);
  const Int32Tree::ConstPtr tree = detail::withoutTiles(labels),
                            ballTree = detail::withoutTiles(balls);
  const Grains grains = collect(*tree, *ballTree, blocks);
  std::vector<Clump> result(blocks.labels().size());
  detail::parallelFor(result.size(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) {
      Clump& clump = result[g];
      clump.label = blocks.labels()[g];
      clump.voxels = clump.uncovered = blocks.voxelCounts()[g];
      BitBox uncovered = voxelsOf(*tree, clump.label, grains.boxes[g]);
      chooseBalls(grains.balls[g], options, uncovered, clump);
      measure(uncovered, clump);
    }
  });
  return result;
}

}  // namespace vdb_madf
