// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/snow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.h"
#include "support/samples.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

SnowOptions smallSnow() {
  SnowOptions options;
  options.size = {60, 49, 71};
  options.length = 28;
  options.seed = 5;
  return options;
}

/// Power of the object at wave vectors of n periods in an edge, averaged over directions.
double spectrum(const Sample& sample, int edge, int n) {
  std::vector<double> cosine(static_cast<size_t>(edge)), sine(cosine.size());
  for (int i = 0; i < edge; ++i) {
    cosine[size_t(i)] = std::cos(2 * M_PI * i / edge);
    sine[size_t(i)] = std::sin(2 * M_PI * i / edge);
  }
  double sum = 0;
  int count = 0;
  std::vector<Coord> voxels;
  const auto box = CoordBBox::createCube(Coord(0), edge);
  const auto object = sample.object->getConstAccessor();
  for (auto p = box.begin(); p; ++p)
    if (object.isValueOn(*p)) voxels.push_back(*p);
  for (int x = 0; x <= n; ++x)
    for (int y = -n; y <= n; y += 2)
      for (int z = -n; z <= n; z += 2) {
        if (std::abs(std::sqrt(x * x + y * y + z * z) - n) > 0.3) continue;
        double re = 0, im = 0;
        for (const Coord& p : voxels) {
          const int phase = (x * p.x() + y * p.y() + z * p.z()) % edge;
          const auto at = size_t(phase < 0 ? phase + edge : phase);
          re += cosine[at];
          im += sine[at];
        }
        sum += re * re + im * im;
        ++count;
      }
  return sum / count;
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("snow: the bits are fixed", "[snow]") {
  CHECK(hash(generateSnow(smallSnow())) == 0x50fc155e98ee583au);
}

TEST_CASE("snow: seeds differ, threads do not matter", "[snow]") {
  requireSeedsDiffer([](uint64_t seed) {
    auto options = smallSnow();
    options.seed = seed;
    return generateSnow(options);
  });
  auto options = smallSnow();
  options.size = {140, 60, 135};  // several blocks
  requireSameForAnyThreads([&] { return generateSnow(options); });
}

TEST_CASE("snow: no voxel lies outside the box", "[snow]") {
  const Sample sample = generateSnow(smallSnow());
  requireInsideDomain(sample);
  CHECK(!sample.truth);
}

TEST_CASE("snow: meets its fraction and wavelength", "[snow]") {
  for (const double fraction : {0.02, 0.3, 0.5, 0.9}) {
    CAPTURE(fraction);
    SnowOptions options = smallSnow();
    options.fraction = fraction;
    CHECK(std::abs(solidFraction(generateSnow(options)) - fraction) <= 0.005);
  }
  constexpr int kEdge = 80;
  SnowOptions options;
  options.size = Coord(kEdge);
  options.fraction = 0.5;
  for (const int periods : {4, 6, 8}) {
    CAPTURE(periods);
    options.length = double(kEdge) / periods;
    std::vector<double> powers(12);
    for (options.seed = 1; options.seed <= 3; ++options.seed) {
      const Sample sample = generateSnow(options);
      for (int n = periods - 2; n <= periods + 3; ++n)
        powers[size_t(n)] += spectrum(sample, kEdge, n);
    }
    const auto peak = std::max_element(powers.begin(), powers.end()) - powers.begin();
    CHECK(std::abs(int(peak) - periods) <= 1);
  }
}

TEST_CASE("snow: in thin boxes", "[snow]") {
  SnowOptions snow;
  snow.size = {1, 200, 3};
  CHECK(generateSnow(snow).object->activeVoxelCount() > 0);
}

TEST_CASE("snow: bad options are refused", "[snow]") {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refuses = [](auto change) {
    SnowOptions options = smallSnow();
    change(options);
    CHECK_THROWS_AS(generateSnow(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {10, 10, 0}; });
  refuses([](auto& o) { o.fraction = 1.5; });
  refuses([](auto& o) { o.length = 3; });
  refuses([&](auto& o) { o.length = infinity; });
}

TEST_CASE("snow: stops when asked to", "[snow]") {
  requireStops([](Interrupter* stop) { return generateSnow(smallSnow(), stop); });
}
