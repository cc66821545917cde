// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Clumps of balls in the place of grains, by visiting every voxel.

#include "vdb_madf/shapes/clumps.h"

#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/method/voxel_weights.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Every voxel with its squared distance to the nearest voxel that has no label, nearer than 40.
LabelMap distances(const LabelMap& voxels) {
  LabelMap result;
  for (const auto& [p, label] : voxels) {
    int64_t nearest = 1600;
    const int reach = 12;
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z)
          if (x * x + y * y + z * z < nearest && !voxels.count(p.offsetBy(x, y, z)))
            nearest = x * x + y * y + z * z;
    result[p] = int32_t(nearest);
  }
  return result;
}

struct Truth {
  int64_t uncovered = 0, outside = 0;
  double farthest = 0;
};

/// By visiting every voxel.
Truth measured(const LabelMap& voxels, const Clump& clump) {
  Truth truth;
  std::set<Coord> covered;
  for (const Clump::Ball& ball : clump.balls) {
    const int reach = int(std::sqrt(double(ball.squaredRadius))) + 1;
    for (int x = -reach; x <= reach; ++x)
      for (int y = -reach; y <= reach; ++y)
        for (int z = -reach; z <= reach; ++z)
          if (x * x + y * y + z * z < ball.squaredRadius)
            covered.insert(ball.center.offsetBy(x, y, z));
  }
  for (const auto& [p, label] : voxels) {
    if (label != clump.label || covered.count(p)) continue;
    ++truth.uncovered;
    double nearest = 1e9;
    for (const Clump::Ball& ball : clump.balls)
      nearest = std::min(
          nearest, (p - ball.center).asVec3d().length() - std::sqrt(double(ball.squaredRadius)));
    truth.farthest = std::max({truth.farthest, nearest, 0.0});
  }
  for (const Coord& p : covered) {
    const auto found = voxels.find(p);
    truth.outside += found == voxels.end() || found->second != clump.label;
  }
  return truth;
}

/// Each ball in turn the one that covers most, found by asking all of them.
std::vector<Coord> greedyCenters(const LabelMap& voxels, const LabelMap& balls, size_t most) {
  std::set<Coord> uncovered;
  for (const auto& [p, label] : voxels) uncovered.insert(p);
  std::vector<Coord> chosen;
  while (chosen.size() < most) {
    const auto covers = [](const auto& ball, const Coord& p) {
      const Coord away = p - ball.first;
      return away.x() * away.x() + away.y() * away.y() + away.z() * away.z() < ball.second;
    };
    std::pair<int64_t, int32_t> best{0, 0};
    auto winner = balls.end();
    for (auto ball = balls.begin(); ball != balls.end(); ++ball) {
      int64_t gain = 0;
      for (const Coord& p : uncovered) gain += covers(*ball, p);
      // Centers ascend: of equal balls the first stays.
      if (std::pair(gain, ball->second) > best) best = {gain, (winner = ball)->second};
    }
    if (best.first == 0) break;
    chosen.push_back(winner->first);
    for (auto p = uncovered.begin(); p != uncovered.end();)
      p = covers(*winner, *p) ? uncovered.erase(p) : std::next(p);
  }
  return chosen;
}

}  // namespace

TEST_CASE("clumps: cover, excess and distance are those of the voxels", "[clumps]") {
  const LabelMap voxels = twoBalls({-5, 60, 3}, 7);
  const auto labels = labelGrid(voxels), balls = labelGrid(distances(voxels));
  for (const ClumpOptions& options : {ClumpOptions{1, 0}, ClumpOptions{5, 0},
                                      ClumpOptions{1000, 0.05}, ClumpOptions{100000, 0}}) {
    const auto made = clumps(*labels, *balls, options);
    REQUIRE(made.size() == 2);
    for (const Clump& clump : made) {
      const Truth truth = measured(voxels, clump);
      CHECK(clump.voxels == volumes(voxels).at(clump.label));
      CHECK(clump.uncovered == truth.uncovered);
      CHECK(clump.outside == truth.outside);
      CHECK(clump.farthest == Approx(truth.farthest));
      CHECK(int(clump.balls.size()) <= options.mostBalls);
      if (int(clump.balls.size()) < options.mostBalls)
        CHECK(double(clump.uncovered) <= options.coverageError * double(clump.voxels));
      for (const Clump::Ball& ball : clump.balls) CHECK(voxels.at(ball.center) == clump.label);
    }
  }
}

TEST_CASE("clumps: the ball that covers most comes first", "[clumps]") {
  LabelMap voxels;
  for (int x = -9; x <= 30; ++x)
    for (int y = -9; y <= 9; ++y)
      for (int z = -9; z <= 9; ++z) {
        const int rest = y * y + z * z;
        if (x * x + rest < 64 || (x - 11) * (x - 11) + rest < 25) voxels[{x, y, z}] = 1;
      }
  const auto made = clumps(*labelGrid(voxels), *labelGrid(distances(voxels)), {2, 0});
  REQUIRE(made[0].balls.size() == 2);
  CHECK(made[0].balls[0].center == Coord(0));
  CHECK(made[0].balls[0].squaredRadius == 64);
  CHECK(made[0].balls[1].center == Coord(11, 0, 0));
  CHECK(made[0].farthest < 2);
  CHECK(std::abs(made[0].volumeError()) < 0.02);
}

TEST_CASE("clumps: the balls that a search of all of them finds", "[clumps]") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    // Longer than two words of bits along z, across the origin.
    LabelMap voxels, balls;
    for (int x = -3; x < 4; ++x)
      for (int y = 5; y < 10; ++y)
        for (int z = -71; z < 95; ++z) {
          if (random() % 3 == 0) continue;
          voxels[{x, y, z}] = 4;
          // Small ones, some that are cut off, and some too large for one word.
          if (random() % 40 == 0) balls[{x, y, z}] = 1 + int32_t(random() % 30);
          if (random() % 400 == 0) balls[{x, y, z}] = 300 + int32_t(random() % 1000);
        }
    const auto made = clumps(*labelGrid(voxels), *labelGrid(balls), {60, 0});
    std::vector<Coord> centers;
    for (const Clump::Ball& ball : made[0].balls) centers.push_back(ball.center);
    CHECK(centers == greedyCenters(voxels, balls, 60));
  }
}

TEST_CASE("clumps: a ball whose center lies in a cavity is that of the grain around it",
          "[clumps]") {
  LabelMap voxels, balls;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x || y || z) voxels[{x, y, z}] = z < 1 ? 5 : 3;
  balls[Coord(0)] = 4;
  balls[Coord(40, 0, 0)] = 1000000;  // of no grain
  const auto made = clumps(*labelGrid(voxels), *labelGrid(balls), {10, 0});
  REQUIRE(made.size() == 2);
  CHECK(made[0].label == 3);
  CHECK(made[0].balls.empty());
  REQUIRE(made[1].balls.size() == 1);  // at (-1, 0, 0), as near as (0, 0, 1)
  CHECK(made[1].balls[0].center == Coord(0));
  CHECK(made[1].uncovered == 0);
  // (-5, 0, 0) and (3, 4, 0) are equally near.
  const auto tie =
      clumps(*labelGrid({{{-5, 0, 0}, 1}, {{3, 4, 0}, 2}}), *labelGrid({{Coord(0), 26}}), {10, 0});
  REQUIRE(tie.size() == 2);
  CHECK(tie[0].balls.size() == 1);
  CHECK(tie[1].balls.empty());
}

TEST_CASE("clumps: same for any number of threads; no balls, no labels, wrong options",
          "[clumps]") {
  const LabelMap voxels = randomLabels(3, Coord(-4), 12, 4, 95);
  const auto labels = labelGrid(voxels), balls = labelGrid(distances(voxels));
  const auto made = clumps(*labels, *balls, {7, 0.01});
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const auto other = clumps(*labels, *balls, {7, 0.01});
    for (size_t g = 0; g < made.size(); ++g) {
      REQUIRE(other[g].balls.size() == made[g].balls.size());
      for (size_t i = 0; i < made[g].balls.size(); ++i)
        CHECK(other[g].balls[i].center == made[g].balls[i].center);
    }
  }
  const auto without = clumps(*labels, *labelGrid({}));
  CHECK(without[0].balls.empty());
  CHECK(without[0].uncovered == without[0].voxels);
  CHECK(clumps(*labelGrid({}), *balls).empty());
  CHECK_THROWS_AS(clumps(*labels, *balls, {0, 0}), InvalidInput);
  CHECK_THROWS_AS(clumps(*labels, *balls, {1, 1.5}), InvalidInput);
}

namespace {

/// Squared distance from a point to the nearest voxel of another grain.
int64_t toOtherGrain(const LabelMap& voxels, const Coord& p, int32_t label) {
  int64_t nearest = std::numeric_limits<int32_t>::max();
  for (const auto& [q, other] : voxels)
    if (other != label) nearest = std::min(nearest, int64_t((q - p).asVec3d().lengthSqr()));
  return nearest;
}

/// The squared radius that a ball has to have, from the definition: it ends at voxels of other
/// grains, then at the planes between it and the other balls (with such radii).
double radiusApart(const LabelMap& voxels, const LabelMap& balls, const std::vector<Clump>& made,
                   const Clump& own, const Coord& center) {
  const auto inOwnGrain = [&](const Coord& p, int32_t label) {
    return double(std::min<int64_t>(balls.at(p), toOtherGrain(voxels, p, label)));
  };
  const double square = inOwnGrain(center, own.label);
  double radius = std::sqrt(square);
  for (const Clump& clump : made)
    for (const Clump::Ball& ball : clump.balls) {
      if (clump.label == own.label) continue;
      const double other = inOwnGrain(ball.center, clump.label),
                   d = (ball.center - center).asVec3d().length();
      if (std::sqrt(square) + std::sqrt(other) > d)
        radius = std::min(radius, (d * d + square - other) / (2 * d));
    }
  return radius * radius;
}

}  // namespace

TEST_CASE("clumps: kept apart, balls end at other grains and do not overlap theirs", "[clumps]") {
  LabelMap three = twoBalls({-5, 60, 3}, 7);
  for (const auto& [p, label] : twoBalls({-1, 68, 5}, 5))
    if (!three.count(p)) three[p] = 11;
  for (const LabelMap& voxels : {three, randomLabels(5, Coord(-3), 8, 3, 97)}) {
    const LabelMap map = distances(voxels);
    const auto labels = labelGrid(voxels), balls = labelGrid(map);
    double deepest = 0;  // overlap without the option: there is something to do
    for (const int most : {100000, 4}) {
      const auto made = clumps(*labels, *balls, {most, 0, true});
      for (const Clump& clump : clumps(*labels, *balls, {most, 0}))
        deepest = std::max(deepest, double(clump.outside));
      for (const Clump& clump : made) {
        REQUIRE_FALSE(clump.balls.empty());
        const Truth truth = measured(voxels, clump);
        CHECK(clump.uncovered == truth.uncovered);
        CHECK(clump.outside == truth.outside);
        CHECK(clump.outside == 0);
        CHECK(clump.farthest == Approx(truth.farthest));
        for (const Clump::Ball& ball : clump.balls) {
          CHECK(ball.squaredRadius ==
                Approx(radiusApart(voxels, map, made, clump, ball.center)).epsilon(1e-12));
          for (const Clump& other : made)
            for (const Clump::Ball& there : other.balls)
              if (other.label != clump.label)
                CHECK(std::sqrt(ball.squaredRadius) + std::sqrt(there.squaredRadius) <=
                      (there.center - ball.center).asVec3d().length() + 1e-9);
        }
      }
    }
    CHECK(deepest > 0);
  }
}

TEST_CASE("clumps: kept apart, a grain that touches none is as it was", "[clumps]") {
  LabelMap voxels = twoBalls({-5, 60, 3}, 7);
  for (auto& [p, label] : voxels) label = 4;
  voxels[{60, 60, 60}] = 9;
  const auto labels = labelGrid(voxels), balls = labelGrid(distances(voxels));
  const auto whole = clumps(*labels, *balls, {20, 0}),
             apart = clumps(*labels, *balls, {20, 0, true});
  REQUIRE(apart.size() == 2);
  for (size_t g = 0; g < apart.size(); ++g) {
    REQUIRE(apart[g].balls.size() == whole[g].balls.size());
    for (size_t i = 0; i < apart[g].balls.size(); ++i) {
      CHECK(apart[g].balls[i].center == whole[g].balls[i].center);
      CHECK(apart[g].balls[i].squaredRadius == whole[g].balls[i].squaredRadius);
    }
  }
  CHECK(clumps(*labelGrid({}), *labelGrid({}), {20, 0, true}).empty());
}

namespace {

/// |p - q|^2 of voxels, in the unit of the weights.
int64_t square(const Coord& p, const Coord& q, const VoxelWeights& weights) {
  int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    sum += int64_t(weights[axis]) * (p[axis] - q[axis]) * (p[axis] - q[axis]);
  return sum;
}

/// Every voxel with its squared distance to the nearest one around that has no label.
LabelMap distances(const LabelMap& voxels, const VoxelWeights& weights) {
  std::vector<Coord> background;
  CoordBBox box;
  for (const auto& [p, label] : voxels) box.expand(p);
  box.expand(1);
  for (auto p = box.begin(); p; ++p)
    if (!voxels.count(*p)) background.push_back(*p);
  LabelMap result;
  for (const auto& [p, label] : voxels) {
    int64_t nearest = std::numeric_limits<int32_t>::max();
    for (const Coord& q : background) nearest = std::min(nearest, square(p, q, weights));
    result[p] = int32_t(nearest);
  }
  return result;
}

}  // namespace

TEST_CASE("clumps: of unequal voxels, balls are round in space", "[clumps]") {
  struct Shape {
    std::array<double, 3> edges;
    VoxelWeights weights;
  };
  const LabelMap voxels = twoBalls({-5, 60, 3}, 5);
  for (const Shape& shape : {Shape{{1, 1, 2}, {1, 1, 4}}, Shape{{0.3, 0.2, 0.2}, {9, 4, 4}},
                             Shape{{5, 7, 6}, {25, 49, 36}}}) {
    const VoxelWeights& weights = shape.weights;
    const double unit = weights.least();
    const auto labels = labelGrid(voxels), balls = labelGrid(distances(voxels, weights));
    setProportions(*labels, shape.edges);
    CHECK_FALSE(areBallsOfVoxels(*labels, *balls));
    CHECK_THROWS_WITH(clumps(*labels, *balls), vdb_madf::test::Contains("other voxels"));
    setWeights(*balls, weights);
    CHECK(areBallsOfVoxels(*labels, *balls));
    const auto apartFrom = [&](const Coord& p, const Coord& q) {
      return std::sqrt(double(square(p, q, weights)) / unit);
    };
    for (const bool apart : {false, true})
      for (const int most : {100000, 4}) {
        CAPTURE(weights.toString(), apart, most);
        const auto made = clumps(*labels, *balls, {most, 0, apart});
        REQUIRE(made.size() == 2);
        for (const Clump& clump : made) {
          std::set<Coord> covered;
          for (const Clump::Ball& ball : clump.balls) {
            CoordBBox box(ball.center, ball.center);
            box.expand(int(std::sqrt(ball.squaredRadius)) + 1);
            for (auto p = box.begin(); p; ++p)
              if (double(square(*p, ball.center, weights)) < ball.squaredRadius * unit)
                covered.insert(*p);
          }
          int64_t uncovered = 0, outside = 0;
          double farthest = 0;
          for (const auto& [p, label] : voxels) {
            if (label != clump.label || covered.count(p)) continue;
            ++uncovered;
            double nearest = 1e9;
            for (const Clump::Ball& ball : clump.balls)
              nearest =
                  std::min(nearest, apartFrom(p, ball.center) - std::sqrt(ball.squaredRadius));
            farthest = std::max(farthest, nearest);
          }
          for (const Coord& p : covered) outside += !voxels.count(p) || voxels.at(p) != clump.label;
          CHECK(clump.uncovered == uncovered);
          CHECK(clump.outside == outside);
          CHECK((apart ? outside == 0 : most < 5 || outside > 0));
          CHECK(clump.farthest == Approx(farthest));
          CHECK((most < 5 || apart || uncovered == 0));
        }
        bool overlap = false;
        for (const Clump::Ball& a : made[0].balls)
          for (const Clump::Ball& b : made[1].balls)
            overlap = overlap || std::sqrt(a.squaredRadius) + std::sqrt(b.squaredRadius) >
                                     apartFrom(a.center, b.center) + 1e-9;
        CHECK((!apart || !overlap));
      }
  }
}
