// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/generate.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "support/balls.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/detail/sphere_placement.h"

using namespace vdb_madf;
using brute::inUnion;
using brute::nearest;
using brute::power;
using detail::Ball;

namespace {

constexpr double kPi = 3.14159265358979323846;

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

PackOptions smallPack() {
  PackOptions options;
  options.size = {70, 64, 57};
  options.minRadius = 2;
  options.maxRadius = 6;
  options.seed = 4;
  return options;
}

SnowOptions smallSnow() {
  SnowOptions options;
  options.size = {60, 49, 71};
  options.length = 28;
  options.seed = 5;
  return options;
}

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

/// The bits of object and truth, whatever the trees hold as tiles.
uint64_t hash(const Sample& sample) {
  uint64_t state = 0;
  const CoordBBox box = *storedDomain(*sample.object);
  const auto object = sample.object->getConstAccessor();
  for (auto p = box.begin(); p; ++p) {
    const int32_t label = sample.truth ? sample.truth->tree().getValue(*p) : 0;
    state = detail::mixBits(state ^ (uint64_t(uint32_t(label)) << 1 | object.isValueOn(*p)));
  }
  return state;
}

double overlapOf(const std::vector<Ball>& balls, int64_t unionVoxels) {
  double volume = 0;
  for (const Ball& ball : balls) volume += 4 / 3.0 * kPi * std::pow(ball.radius, 3);
  return volume / double(unionVoxels) - 1;
}

double solidFraction(const Sample& sample) {
  return double(sample.object->activeVoxelCount()) / double(storedDomain(*sample.object)->volume());
}

std::set<int32_t> labelsOf(const Int32Grid& grid) {
  std::set<int32_t> labels;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) labels.insert(*voxel);
  return labels;
}

void requireTruth(const Sample& sample, const std::vector<Ball>& balls) {
  REQUIRE(sample.truth);
  CHECK(sample.truth->tree().hasSameTopology(sample.object->tree()));
  size_t wrong = 0;
  for (auto voxel = sample.truth->cbeginValueOn(); voxel; ++voxel)
    wrong += *voxel != nearest(balls, voxel.getCoord());
  CHECK(wrong == 0);
  const auto labels = labelsOf(*sample.truth);
  CHECK(labels.size() == balls.size());
  CHECK(*labels.begin() == 1);
}

/// Power of the object at wave vectors of n periods in an edge, averaged over directions.
double spectrum(const Sample& sample, int edge, int n) {
  std::vector<double> cosine(static_cast<size_t>(edge)), sine(cosine.size());
  for (int i = 0; i < edge; ++i) {
    cosine[size_t(i)] = std::cos(2 * kPi * i / edge);
    sine[size_t(i)] = std::sin(2 * kPi * i / edge);
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

class StopAfter : public Interrupter {
 public:
  explicit StopAfter(int polls) : polls_(polls) {}
  bool wasInterrupted(int) override { return --polls_ < 0; }

 private:
  std::atomic<int> polls_;
};

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("generate: the bits are fixed", "[generate]") {
  CHECK(hash(generateSpheres(smallSpheres())) == 0x3b5308b6ffb7464cu);
  CHECK(hash(generatePack(smallPack())) == 0x1cd81e19a1586587u);
  CHECK(hash(generateSnow(smallSnow())) == 0x50fc155e98ee583au);
  CHECK(hash(generateSintered(smallSintered())) == 0x6d9b2a8c7edc9264u);
}

TEST_CASE("generate: seeds differ", "[generate]") {
  auto spheres = smallSpheres();
  auto pack = smallPack();
  auto snow = smallSnow();
  auto sintered = smallSintered();
  std::set<uint64_t> hashes;
  for (const uint64_t seed : {1, 2, 3}) {
    spheres.seed = pack.seed = snow.seed = sintered.seed = seed;
    hashes.insert({hash(generateSpheres(spheres)), hash(generatePack(pack)),
                   hash(generateSnow(snow)), hash(generateSintered(sintered))});
  }
  CHECK(hashes.size() == 12);
}

TEST_CASE("generate: threads do not matter", "[generate]") {
  SinteredOptions sintered = smallSintered();
  PackOptions pack = smallPack();
  SnowOptions snow = smallSnow();
  sintered.size = pack.size = snow.size = {140, 60, 135};  // several blocks
  const auto all = [&] {
    return std::vector<uint64_t>{hash(generateSpheres(smallSpheres())), hash(generatePack(pack)),
                                 hash(generateSnow(snow)), hash(generateSintered(sintered))};
  };
  std::vector<uint64_t> one, two;
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    one = all();
  }
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 2);
    two = all();
  }
  CHECK(one == two);
}

TEST_CASE("generate: a sample explains itself", "[generate]") {
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
  CHECK(!generatePack(smallPack()).truth);
  CHECK(!generateSnow(smallSnow()).truth);
}

TEST_CASE("generate: no voxel lies outside the box", "[generate]") {
  for (const Sample& sample : {generateSpheres(smallSpheres()), generatePack(smallPack()),
                               generateSnow(smallSnow()), generateSintered(smallSintered())})
    CHECK(storedDomain(*sample.object)->isInside(sample.object->evalActiveVoxelBoundingBox()));
}

TEST_CASE("generate: spheres are as documented", "[generate]") {
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

TEST_CASE("generate: the sphere sets of Table 1", "[generate]") {
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

TEST_CASE("generate: spheres of no overlap share no voxel", "[generate]") {
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

TEST_CASE("generate: a pack meets its fraction", "[generate]") {
  for (const double fraction : {0.01, 0.25, 0.6, 0.97}) {
    CAPTURE(fraction);
    PackOptions options = smallPack();
    options.fraction = fraction;
    CHECK(std::abs(solidFraction(generatePack(options)) - fraction) <= 0.005);
    options.size = Coord(40);
    options.minRadius = 8;
    options.maxRadius = 28;
    if (fraction < 0.9) CHECK(std::abs(solidFraction(generatePack(options)) - fraction) <= 0.005);
  }
}

TEST_CASE("generate: a pack is as dense at the faces as within", "[generate]") {
  PackOptions options;
  options.size = Coord(200);
  options.minRadius = 3;
  options.maxRadius = 8;
  const Sample sample = generatePack(options);
  int64_t face = 0;
  for (auto p = CoordBBox({0, 0, 0}, {3, 199, 199}).begin(); p; ++p)
    face += sample.object->tree().isValueOn(*p);
  CHECK(double(face) / (4 * 200 * 200) == Approx(0.25).margin(0.03));
  CHECK(sample.object->tree().activeTileCount() > 0);
}

TEST_CASE("generate: snow meets its fraction and wavelength", "[generate]") {
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

TEST_CASE("generate: sintered balls keep their distance", "[generate]") {
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

TEST_CASE("generate: a sintered surface is the cut of the blurred, noisy union", "[generate]") {
  SinteredOptions options = smallSintered();
  options.size = {150, 30, 40};  // two blocks
  for (const double roughness : {0.0, 0.8}) {
    options.roughness = roughness;
    const auto balls = detail::placeSintered(options, nullptr);
    const Sample sample = generateSintered(options);
    const detail::WhiteNoise noise(options.seed, 1);
    const auto weight = [](int k, double sigma) {
      return std::exp(-k * k / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * kPi));
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

TEST_CASE("generate: one voxel and thin boxes", "[generate]") {
  SnowOptions snow;
  snow.size = {1, 200, 3};
  CHECK(generateSnow(snow).object->activeVoxelCount() > 0);
  PackOptions pack;
  pack.size = {300, 1, 300};
  CHECK(std::abs(solidFraction(generatePack(pack)) - 0.25) <= 0.005);
  pack.size = Coord(1);
  CHECK_THROWS_AS(generatePack(pack), InvalidInput);
  SinteredOptions sintered;
  sintered.size = Coord(1);
  sintered.count = 1;
  CHECK(generateSintered(sintered).truth->activeVoxelCount() == 1);
}

TEST_CASE("generate: bad options are refused", "[generate]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refusesSpheres = [](auto change) {
    SphereOptions options = smallSpheres();
    change(options);
    CHECK_THROWS_AS(generateSpheres(options), InvalidInput);
  };
  refusesSpheres([](auto& o) { o.size = {0, 10, 10}; });
  refusesSpheres([](auto& o) { o.size = {100, 100, 26755}; });
  refusesSpheres([](auto& o) { o.count = 0; });
  refusesSpheres([](auto& o) { o.count = -3; });
  refusesSpheres([](auto& o) { o.minRadius = 0; });
  refusesSpheres([](auto& o) { o.minRadius = 12; });
  refusesSpheres([](auto& o) { o.maxRadius = 40; });
  refusesSpheres([&](auto& o) { o.maxRadius = infinity; });
  refusesSpheres([&](auto& o) { o.minRadius = nan; });
  refusesSpheres([](auto& o) { o.overlap = -0.1; });
  refusesSpheres([&](auto& o) { o.overlap = nan; });
  refusesSpheres([](auto& o) { o.overlap = 0.001; });
  refusesSpheres([](auto& o) { o.overlap = 50; });

  const auto refusesPack = [](auto change) {
    PackOptions options = smallPack();
    change(options);
    CHECK_THROWS_AS(generatePack(options), InvalidInput);
  };
  refusesPack([](auto& o) { o.size = {10, -1, 10}; });
  refusesPack([](auto& o) { o.fraction = 0; });
  refusesPack([](auto& o) { o.fraction = 1; });
  refusesPack([&](auto& o) { o.fraction = nan; });
  refusesPack([](auto& o) { o.minRadius = 0.1; });
  refusesPack([](auto& o) { o.maxRadius = 1e9; });

  const auto refusesSnow = [](auto change) {
    SnowOptions options = smallSnow();
    change(options);
    CHECK_THROWS_AS(generateSnow(options), InvalidInput);
  };
  refusesSnow([](auto& o) { o.size = {10, 10, 0}; });
  refusesSnow([](auto& o) { o.fraction = 1.5; });
  refusesSnow([](auto& o) { o.length = 3; });
  refusesSnow([&](auto& o) { o.length = infinity; });

  const auto refusesSintered = [](auto change) {
    SinteredOptions options = smallSintered();
    change(options);
    CHECK_THROWS_AS(generateSintered(options), InvalidInput);
  };
  refusesSintered([](auto& o) { o.size = {0, 0, 0}; });
  refusesSintered([](auto& o) { o.count = 0; });
  refusesSintered([](auto& o) { o.neck = -1; });
  refusesSintered([&](auto& o) { o.neck = nan; });
  refusesSintered([](auto& o) { o.roughness = -1; });
  refusesSintered([&](auto& o) { o.roughness = infinity; });
}

TEST_CASE("generate: says how many balls fit", "[generate]") {
  SinteredOptions options = smallSintered();
  options.count = 500;
  CHECK_THROWS_WITH(generateSintered(options),
                    Catch::Contains("of 500 balls fit") && !Catch::Contains("\n"));
}

TEST_CASE("generate: stops when asked to", "[generate]") {
  for (const int polls : {0, 1}) {
    StopAfter a(polls), b(polls), c(polls), d(polls);
    CHECK_THROWS_AS(generateSpheres(smallSpheres(), &a), Interrupted);
    CHECK_THROWS_AS(generatePack(smallPack(), &b), Interrupted);
    CHECK_THROWS_AS(generateSnow(smallSnow(), &c), Interrupted);
    CHECK_THROWS_AS(generateSintered(smallSintered(), &d), Interrupted);
  }
}
