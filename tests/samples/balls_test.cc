// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/balls.h"

#include <limits>
#include <string>

#include "support/balls.h"
#include "support/catch.h"
#include "support/samples.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::Ball;

/// Not in the order of their centers; the second and the third overlap.
BallOptions threeBalls() {
  BallOptions options;
  options.balls = {{3, 0, 0.5}, {-1, 0.25, 0, 1.5}, {0, -1, 0}};
  options.radius = 6;
  return options;
}

}  // namespace

TEST_CASE("balls: a list is read as it may be written", "[balls]") {
  const auto balls = parseBalls("# x y z\n1 2 3\n\n -1,+2.5, 3e1\t0.5 # large\r\n4\t5\t6\r\n");
  REQUIRE(balls.size() == 3);
  CHECK(balls[0].radius == 1);
  CHECK((balls[1].x == -1 && balls[1].y == 2.5 && balls[1].z == 30 && balls[1].radius == 0.5));
  CHECK((balls[2].x == 4 && balls[2].z == 6 && balls[2].radius == 1));
  const auto numbered = parseBalls("7 1 2 3\n8 4 5 6 2", true);
  REQUIRE(numbered.size() == 2);
  CHECK((numbered[0].x == 1 && numbered[0].z == 3 && numbered[0].radius == 1));
  CHECK((numbered[1].x == 4 && numbered[1].radius == 2));
}

TEST_CASE("balls: a bad line is named", "[balls]") {
  const auto says = [](const std::string& text, const std::string& what, bool numbered = false) {
    CHECK_THROWS_WITH(parseBalls(text, numbered), Contains(what));
  };
  says("", "there is no ball");
  says("# 1 2 3\n\n", "there is no ball");
  says("1 2 3\n# a\n1 2\n", "line 3: has 2 numbers");
  says("1 2 3 4 5", "line 1: has 5 numbers");
  says("1 2 3 4 5 6", "line 1: has 6 numbers", true);
  says("1 2 3", "line 1: has 3 numbers: write n x y z", true);
  says("x y z\n1 2 3", "line 1: 'x y z'");
  says("1 2 nan", "line 1: ");
  says("1 2 inf", "line 1: ");
  says("1 2 3 0", "line 1: the radius must be above 0, not 0");
  says("1 -0.3 0.1 -0.5", "--numbered");
}

TEST_CASE("balls: lie in their bounding box, numbered in the order of the list", "[balls]") {
  const Sample sample = generateBalls(threeBalls());
  // From -2.5 to 4, -2 to 1.75 and -1.5 to 1.5 in units: 39, 22.5 and 18 voxels.
  CHECK(storedDomain(*sample.object)->box() == CoordBBox(Coord(0), {38, 22, 17}));
  const std::vector<Ball> balls{{32.5, 11.75, 11.5, 6}, {8.5, 13.25, 8.5, 9}, {14.5, 5.75, 8.5, 6}};
  requireInsideDomain(sample);
  requireTruth(sample, balls);
  for (auto p = storedDomain(*sample.object)->box().begin(); p; ++p)
    CHECK(sample.object->tree().isValueOn(*p) == brute::inUnion(balls, *p));
  CHECK(sample.object->metaValue<std::string>(kSourceKey) ==
        "generate balls LIST --dims 39x23x18 --radius 6");
  requireSameForAnyThreads([] { return generateBalls(threeBalls()); });
}

TEST_CASE("balls: a size cuts out the middle, or goes beyond the balls", "[balls]") {
  BallOptions options = threeBalls();
  const Sample whole = generateBalls(options);
  options.size = Coord(13, 11, 8);
  const Sample part = generateBalls(options);
  for (auto p = CoordBBox(Coord(0), {12, 10, 7}).begin(); p; ++p)
    CHECK(part.object->tree().isValueOn(*p) ==
          whole.object->tree().isValueOn(*p + Coord(13, 6, 5)));
  // The first ball is outside, and leaves no gap.
  CHECK(labelsOf(*part.truth) == std::set<int32_t>{1, 2});
  options.size = Coord(59, 43, 38);
  const Sample larger = generateBalls(options);
  for (auto p = CoordBBox(Coord(0), {38, 22, 17}).begin(); p; ++p)
    CHECK(larger.truth->tree().getValue(*p + Coord(10)) == whole.truth->tree().getValue(*p));
  CHECK(larger.object->activeVoxelCount() == whole.object->activeVoxelCount());
}

TEST_CASE("balls: those that cannot be drawn are refused", "[balls]") {
  const auto says = [](const std::string& what, auto change) {
    BallOptions options = threeBalls();
    change(options);
    CHECK_THROWS_WITH(generateBalls(options), Contains(what));
    CHECK_THROWS_AS(generateBalls(options), InvalidInput);
  };
  const double huge = 1e300, nan = std::numeric_limits<double>::quiet_NaN();
  says("there are no balls", [](auto& o) { o.balls.clear(); });
  says("above 0", [](auto& o) { o.radius = 0; });
  says("above 0", [&](auto& o) { o.radius = nan; });
  says("radius of ball 1", [](auto& o) { o.radius = 0.2; });
  says("radius of ball 2", [](auto& o) { o.radius = 20000; });
  says("along x", [](auto& o) { o.radius = 5000; });
  says("along y", [&](auto& o) { o.balls.push_back({0, huge, 0}); });
  says("size", [](auto& o) { o.size = Coord(0, 4, 4); });
  BallOptions far = threeBalls();
  far.balls.push_back({0, huge, -huge});
  far.size = Coord(10);
  CHECK(generateBalls(far).object->activeVoxelCount() == 0);
}

TEST_CASE("balls: stop when asked to", "[balls]") {
  requireStops([](Interrupter* stop) { return generateBalls(threeBalls(), stop); });
}
