// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/sintered.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/balls.h"
#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/samples/detail/placement.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using brute::inUnion;

SinteredOptions smallSintered() {
  SinteredOptions options;
  options.size = {66, 58, 61};
  options.count = 10;
  options.minRadius = 7;
  options.maxRadius = 11;
  options.roughness = 0.8;
  options.seed = 6;
  return options;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("sintered: the bits are fixed", "[sintered]") {
  CHECK(hash(generateSintered(smallSintered())) == 0x6d9b2a8c7edc9264u);
}

TEST_CASE("sintered: seeds differ, threads do not matter", "[sintered]") {
  requireSeedsDiffer([](uint64_t seed) {
    auto options = smallSintered();
    options.seed = seed;
    return generateSintered(options);
  });
  auto options = smallSintered();
  options.size = {140, 60, 135};  // several blocks
  requireSameForAnyThreads([&] { return generateSintered(options); });
}

TEST_CASE("sintered: no voxel lies outside the box", "[sintered]") {
  requireInsideDomain(generateSintered(smallSintered()));
}

TEST_CASE("sintered: balls keep their distance", "[sintered]") {
  SinteredOptions options = smallSintered();
  for (options.seed = 1; options.seed <= 4; ++options.seed) {
    const auto balls = detail::placeSintered(options, nullptr);
    CHECK(int(balls.size()) == options.count);
    for (size_t i = 0; i < balls.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const double dx = balls[i].x - balls[j].x, dy = balls[i].y - balls[j].y,
                     dz = balls[i].z - balls[j].z;
        CHECK(std::sqrt(dx * dx + dy * dy + dz * dz) >=
              options.neck * (balls[i].radius + balls[j].radius) * (1 - 1e-12));
      }
    requireTruth(generateSintered(options), balls);
  }
}

TEST_CASE("sintered: the surface is the cut of the blurred, noisy union", "[sintered]") {
  SinteredOptions options = smallSintered();
  options.size = {150, 30, 40};  // two blocks
  for (const double roughness : {0.0, 0.8}) {
    options.roughness = roughness;
    const auto balls = detail::placeSintered(options, nullptr);
    const Sample sample = generateSintered(options);
    const detail::WhiteNoise noise(options.seed, 1);
    const auto weight = [](int k, double sigma) {
      return std::exp(-k * k / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * M_PI));
    };
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
      const Coord p(int(random() % 150), int(random() % 30), int(random() % 40));
      double blurred = 0, rough = 0;
      for (auto q = CoordBBox::createCube(Coord(-8), 17).begin(); q; ++q) {
        const Coord k = *q;
        if (inUnion(balls, p + k))
          blurred += weight(k.x(), 2) * weight(k.y(), 2) * weight(k.z(), 2);
        if (roughness > 0 && std::max({std::abs(k.x()), std::abs(k.y()), std::abs(k.z())}) <= 4)
          rough += weight(k.x(), 1) * weight(k.y(), 1) * weight(k.z(), 1) *
                   noise.value(noise.row(p.x() + k.x(), p.y() + k.y()), p.z() + k.z());
      }
      const double value = blurred + roughness * 1.5 * rough;
      if (std::abs(value - 0.45) < 1e-3) continue;
      CAPTURE(p, value);
      CHECK(sample.object->tree().isValueOn(p) == (value >= 0.45));
    }
  }
}

TEST_CASE("sintered: says how many balls fit", "[sintered]") {
  SinteredOptions options = smallSintered();
  options.count = 500;
  CHECK_THROWS_WITH(generateSintered(options), vdb_madf::test::Contains("of 500 balls fit") &&
                                                   !vdb_madf::test::Contains("\n"));
}

TEST_CASE("sintered: one voxel", "[sintered]") {
  SinteredOptions sintered;
  sintered.size = Coord(1);
  sintered.count = 1;
  CHECK(generateSintered(sintered).truth->activeVoxelCount() == 1);
}

TEST_CASE("sintered: bad options are refused", "[sintered]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](auto change) {
    SinteredOptions options = smallSintered();
    change(options);
    CHECK_THROWS_AS(generateSintered(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {0, 0, 0}; });
  refuses([](auto& o) { o.count = 0; });
  refuses([](auto& o) { o.neck = -1; });
  refuses([&](auto& o) { o.neck = nan; });
  refuses([](auto& o) { o.roughness = -1; });
  refuses([&](auto& o) { o.roughness = infinity; });
}

TEST_CASE("sintered: stops when asked to", "[sintered]") {
  requireStops([](Interrupter* stop) { return generateSintered(smallSintered(), stop); });
}
