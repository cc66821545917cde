// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/spheres.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "support/balls.h"
#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/samples/detail/placement.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using brute::inUnion;
using brute::power;
using detail::Ball;

SphereOptions smallSpheres() {
  SphereOptions options;
  options.size = {61, 57, 66};
  options.count = 9;
  options.minRadius = 8;
  options.maxRadius = 11.5;
  options.overlap = 0.12;
  options.seed = 3;
  return options;
}

double overlapOf(const std::vector<Ball>& balls, int64_t unionVoxels) {
  double volume = 0;
  for (const Ball& ball : balls) volume += 4 / 3.0 * M_PI * std::pow(ball.radius, 3);
  return volume / double(unionVoxels) - 1;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("spheres: the bits are fixed", "[spheres]") {
  CHECK(hash(generateSpheres(smallSpheres())) == 0x3b5308b6ffb7464cu);
}

TEST_CASE("spheres: seeds differ, threads do not matter", "[spheres]") {
  requireSeedsDiffer([](uint64_t seed) {
    auto options = smallSpheres();
    options.seed = seed;
    return generateSpheres(options);
  });
  auto options = smallSpheres();
  requireSameForAnyThreads([&] { return generateSpheres(options); });
}

TEST_CASE("spheres: a sample explains itself", "[spheres]") {
  const Sample sample = generateSpheres(smallSpheres());
  for (const openvdb::GridBase* grid :
       {static_cast<const openvdb::GridBase*>(sample.object.get()),
        static_cast<const openvdb::GridBase*>(sample.truth.get())}) {
    CHECK(storedDomain(*grid) == CoordBBox({0, 0, 0}, {60, 56, 65}));
    CHECK(!storedVoxelSize(*grid));
    CHECK(grid->metaValue<std::string>("madf_source") ==
          "generate spheres --dims 61x57x66 --count 9 --radius 8:11.5 --overlap 0.12 --max-cover 2 "
          "--seed 3");
  }
  CHECK(sample.object->getName() == "object");
  CHECK(sample.truth->getName() == "truth");
}

TEST_CASE("spheres: no voxel lies outside the box", "[spheres]") {
  requireInsideDomain(generateSpheres(smallSpheres()));
}

TEST_CASE("spheres: are as documented", "[spheres]") {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    SphereOptions options = smallSpheres();
    options.seed = seed;
    const auto balls = detail::placeSpheres(options, nullptr);
    REQUIRE(int(balls.size()) == options.count);
    for (const Ball& a : balls) {
      CHECK((a.radius >= options.minRadius && a.radius <= options.maxRadius));
      const double center[] = {a.x, a.y, a.z};
      for (int axis = 0; axis < 3; ++axis) {
        CHECK(center[axis] == std::round(center[axis]));
        CHECK(center[axis] - a.radius >= 0);
        CHECK(center[axis] + a.radius <= options.size[axis] - 1);
      }
    }
    const Sample sample = generateSpheres(options);
    size_t wrong = 0, crowded = 0;
    const auto object = sample.object->getConstAccessor();
    const CoordBBox box(Coord(0), options.size.offsetBy(-1));
    for (auto p = box.begin(); p; ++p) {
      wrong += object.isValueOn(*p) != inUnion(balls, *p);
      crowded += std::count_if(balls.begin(), balls.end(),
                               [&](const Ball& b) { return power(b, *p) < 0; }) > 2;
    }
    CHECK(wrong == 0);
    CHECK(crowded == 0);
    requireTruth(sample, balls);
    for (size_t i = 0; i < balls.size(); ++i)
      CHECK(sample.truth->tree().getValue(
                Coord(int(balls[i].x), int(balls[i].y), int(balls[i].z))) == int32_t(i + 1));
    const double overlap = overlapOf(balls, int64_t(sample.object->activeVoxelCount()));
    CHECK(std::abs(overlap - options.overlap) <= 0.01 * options.overlap);
  }
}

TEST_CASE("spheres: the sets of Table 1", "[spheres]") {
  struct Row {
    int count;
    double minRadius, maxRadius, overlap;
  };
  for (const Row& row : {Row{100, 20, 30, 0.08408}, Row{80, 25, 35, 0.14911},
                         Row{60, 30, 40, 0.19667}, Row{40, 35, 45, 0.19068}}) {
    CAPTURE(row.count);
    SphereOptions options;
    options.count = row.count;
    options.minRadius = row.minRadius;
    options.maxRadius = row.maxRadius;
    options.overlap = row.overlap;
    const Sample sample = generateSpheres(options);
    const double overlap = overlapOf(detail::placeSpheres(options, nullptr),
                                     int64_t(sample.object->activeVoxelCount()));
    CHECK(std::abs(overlap - row.overlap) <= 0.01 * row.overlap);
    const auto labels = labelsOf(*sample.truth);
    CHECK(int(labels.size()) == row.count);
    CHECK(*labels.rbegin() == row.count);
  }
}

TEST_CASE("spheres: of no overlap share no voxel", "[spheres]") {
  SphereOptions options = smallSpheres();
  options.overlap = 0;
  options.count = 6;
  const auto balls = detail::placeSpheres(options, nullptr);
  for (size_t i = 0; i < balls.size(); ++i) {
    int64_t shared = 0;
    const CoordBBox box(Coord(0), options.size.offsetBy(-1));
    for (auto p = box.begin(); p; ++p)
      for (size_t j = 0; j < i; ++j) shared += power(balls[i], *p) < 0 && power(balls[j], *p) < 0;
    CHECK(shared == 0);
  }
  options.count = 1;
  CHECK(labelsOf(*generateSpheres(options).truth) == std::set<int32_t>{1});
}

TEST_CASE("spheres: bad options are refused", "[spheres]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](auto change) {
    SphereOptions options = smallSpheres();
    change(options);
    CHECK_THROWS_AS(generateSpheres(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {0, 10, 10}; });
  refuses([](auto& o) { o.size = {100, 100, 26755}; });
  refuses([](auto& o) { o.count = 0; });
  refuses([](auto& o) { o.count = -3; });
  refuses([](auto& o) { o.minRadius = 0; });
  refuses([](auto& o) { o.minRadius = 12; });
  refuses([](auto& o) { o.maxRadius = 40; });
  refuses([&](auto& o) { o.maxRadius = infinity; });
  refuses([&](auto& o) { o.minRadius = nan; });
  refuses([](auto& o) { o.overlap = -0.1; });
  refuses([&](auto& o) { o.overlap = nan; });
  refuses([](auto& o) { o.overlap = 0.001; });
  refuses([](auto& o) { o.overlap = 50; });
}

TEST_CASE("spheres: stops when asked to", "[spheres]") {
  requireStops([](Interrupter* stop) { return generateSpheres(smallSpheres(), stop); });
}
