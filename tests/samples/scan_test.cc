// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/samples/balls.h"
#include "vdb_madf/samples/bed.h"
#include "vdb_madf/samples/detail/bodies.h"
#include "vdb_madf/samples/detail/sample_options.h"
#include "vdb_madf/samples/detail/surface_distance.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/samples/particles.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/spheres.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

Sample plates() {
  ParticleOptions options;
  options.size = {66, 58, 61};
  options.shape = ParticleShape::plates;
  options.count = 10;
  options.minRadius = 7;
  options.maxRadius = 11;
  return generateParticles(options);
}

ScanOptions badScan() {
  ScanOptions options;
  options.seed = 3;
  options.surface = 1.2;
  options.surfaceLength = 5;
  options.blur = 1;
  options.noise = 0.2;
  return options;
}

/// The object below a height, with two grains that meet at half of its width.
Sample halfSpace(const Coord& size, int height) {
  Sample sample;
  sample.object = MaskGrid::create();
  sample.truth = Int32Grid::create();
  for (int x = 0; x < size.x(); ++x)
    for (int y = 0; y < size.y(); ++y)
      for (int z = 0; z < height; ++z) {
        sample.object->tree().setValueOn({x, y, z});
        sample.truth->tree().setValueOn({x, y, z}, x < size.x() / 2 ? 1 : 2);
      }
  return detail::described(sample, size, detail::SourceText("wall"));
}

/// By the definition: 0 if no labeled voxel lies within reach.
int32_t nearestTrue(const Sample& before, const Coord& p, int reach) {
  std::map<int, int32_t> least;
  for (auto k = CoordBBox(Coord(-reach), Coord(reach)).begin(); k; ++k) {
    const Coord d = *k;
    const int square = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
    const int32_t label = before.truth->tree().getValue(p + d);
    if (label == 0 || square > reach * reach) continue;
    const auto [place, isNew] = least.insert({square, label});
    if (!isNew) place->second = std::min(place->second, label);
  }
  return least.empty() ? 0 : least.begin()->second;
}

CoordBBox boxOf(const Sample& sample) {
  return storedDomain(*sample.object)->box();
}

/// The share in the bodies that a gray value without noise stands for.
double shareOf(uint16_t gray) {
  return (gray - 10000) / 20000.0;
}

double sumOfShares(const std::vector<uint16_t>& gray) {
  double sum = 0;
  for (const uint16_t value : gray) sum += shareOf(value);
  return sum;
}

Sample oneBall(double radius, const std::optional<VoxelSize>& voxelSize = {}) {
  BallOptions options;
  options.balls = {{0.2, 0.3, 0.4}};
  options.radius = radius;
  options.size = Coord(2 * int(radius) + 5);
  options.voxelSize = voxelSize;
  return generateBalls(options);
}

/// Air but for a cube with faces at x = 5.25 and so on.
Sample oneCube() {
  Sample sample =
      detail::described({MaskGrid::create(), nullptr}, Coord(11, 1, 1), detail::SourceText("cube"));
  detail::Particle cube;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      detail::Vector row(0);
      row[axis] = side / 20.0;
      cube.rows.push_back(row);
    }
  cube.center = {-14.75, 0, 0};
  cube.reach = 20 * std::sqrt(3.0);
  sample.bodies = detail::particleBodies({cube}, {});
  return sample;
}

int64_t countMoved(const Sample& a, const Sample& b) {
  int64_t moved = 0;
  const CoordBBox box = storedDomain(*a.object)->box();
  for (auto p = box.begin(); p; ++p)
    moved += a.object->tree().isValueOn(*p) != b.object->tree().isValueOn(*p);
  return moved;
}

}  // namespace

TEST_CASE("scan: the bits are fixed", "[scan]") {
  CHECK(hash(scanned(plates(), badScan())) == 0x766dda86e654f9c9u);
}

TEST_CASE("scan: seeds differ, threads do not matter", "[scan]") {
  const Sample sample = plates();
  ScanOptions options = badScan();
  requireSeedsDiffer([&](uint64_t seed) {
    options.seed = seed;
    return scanned(sample, options);
  });
  SinteredOptions large;
  large.size = {140, 60, 135};  // several blocks
  large.count = 12;
  const Sample sintered = generateSintered(large);
  requireSameForAnyThreads([&] { return scanned(sintered, options); });
}

TEST_CASE("scan: without defects the sample stays as it is", "[scan]") {
  const Sample sample = plates();
  CHECK(hash(scanned(sample, {})) == hash(sample));
  ScanOptions tiny;
  tiny.surface = 0.01;
  tiny.noise = 0.01;
  CHECK(hash(scanned(sample, tiny)) == hash(sample));
}

TEST_CASE("scan: says what was done to the sample", "[scan]") {
  const Sample before = plates(), after = scanned(before, badScan());
  const auto source = [](const openvdb::GridBase& grid) {
    return grid.metaValue<std::string>(kSourceKey);
  };
  CHECK(source(*after.object) == source(*before.object) + " --surface 1.2:5 --scan-noise 1:0.2:0");
  CHECK(source(*after.truth) == source(*after.object));
  CHECK(*storedDomain(*after.object) == *storedDomain(*before.object));
}

TEST_CASE("scan: distances from the surface equal the definition", "[scan]") {
  std::mt19937 random(1);
  detail::FloatBox object(CoordBBox(Coord(-3), {14, 12, 13}));
  for (float& v : object.values) v = random() % 12 != 0;
  constexpr int kReach = 3;
  const detail::FloatBox distance = detail::surfaceDistance(object, kReach);
  CHECK(distance.box == CoordBBox(Coord(0), {11, 9, 10}));
  for (auto p = distance.box.begin(); p; ++p) {
    const auto at = [&](const Coord& q) {
      return object.values[object.offset(q.x(), q.y(), q.z())];
    };
    double least = std::numeric_limits<double>::infinity();
    for (auto q = object.box.begin(); q; ++q)
      if (at(*q) != at(*p)) least = std::min(least, (*q - *p).asVec3d().length());
    const float value = distance.values[distance.offset((*p).x(), (*p).y(), (*p).z())];
    if (least <= kReach)
      CHECK(value == Approx(at(*p) == 1 ? 0.5 - least : least - 0.5));
    else
      CHECK(std::abs(value) > kReach - 0.5);
  }
}

TEST_CASE("scan: a flat surface gets the amplitude and the length", "[scan]") {
  const Coord size(160, 160, 40);
  ScanOptions options;
  options.surface = 2;
  options.surfaceLength = 6;
  const Sample after = scanned(halfSpace(size, 20), options);
  std::vector<double> heights;
  for (int x = 0; x < size.x(); ++x)
    for (int y = 0; y < size.y(); ++y) {
      int height = 0;
      for (int z = 0; z < size.z(); ++z) height += after.object->tree().isValueOn({x, y, z});
      heights.push_back(height - 20);
    }
  double sum = 0, squares = 0, atLength = 0;
  for (const double h : heights) {
    sum += h;
    squares += h * h;
  }
  for (int x = 0; x + 6 < size.x(); ++x)
    for (int y = 0; y < size.y(); ++y)
      atLength += heights[size_t(x * size.y() + y)] * heights[size_t((x + 6) * size.y() + y)];
  const double n = double(heights.size());
  CHECK(sum / n == Approx(0).margin(0.3));
  CHECK(std::sqrt(squares / n) == Approx(2).epsilon(0.15));
  CHECK(atLength / (n * (size.x() - 6.0) / size.x()) / (squares / n) ==
        Approx(std::exp(-1)).margin(0.1));
}

TEST_CASE("scan: a voxel that stays keeps its grain, a new one gets the nearest", "[scan]") {
  const Sample before = plates();
  ScanOptions surface;
  surface.surface = 1.2;
  surface.surfaceLength = 5;
  ScanOptions noise;
  noise.blur = 0.8;
  noise.noise = 0.25;
  for (const auto& options : {surface, noise}) {
    const int reach = options.surface > 0 ? 6 : 2;
    const Sample after = scanned(before, options);
    requireInsideDomain(after);
    CHECK(countMoved(before, after) > 1000);
    CHECK(labelsOf(*after.truth) == labelsOf(*before.truth));
    int64_t wrong = 0, specks = 0;
    for (auto voxel = after.object->cbeginValueOn(); voxel; ++voxel) {
      const Coord p = voxel.getCoord();
      const int32_t expected = nearestTrue(before, p, reach);
      wrong += after.truth->tree().getValue(p) != expected;
      wrong += after.truth->tree().isValueOn(p) != (expected > 0);
      specks += expected == 0;
    }
    CHECK(wrong == 0);
    CHECK((specks > 0) == (options.noise > 0));
    CHECK(after.truth->activeVoxelCount() + uint64_t(specks) == after.object->activeVoxelCount());
  }
}

TEST_CASE("scan: the gray values are the blurred object with white noise", "[scan]") {
  const Sample before = halfSpace({40, 30, 20}, 10);
  ScanOptions options;
  options.blur = 1.5;
  options.noise = 0.3;
  const Sample after = scanned(before, options);
  const detail::WhiteNoise noise(options.seed, 3);
  double sum = 0, weights[20];
  for (int k = -9; k <= 10; ++k) sum += weights[k + 9] = std::exp(-k * k / (2 * 1.5 * 1.5));
  for (auto p = CoordBBox(Coord(0), {39, 29, 19}).begin(); p; ++p) {
    // Through the faces at the bottom and the sides it goes on.
    double gray = 0;
    for (int k = -6; k <= 6; ++k)
      if ((*p).z() + k < 10) gray += weights[k + 9] / sum;
    const double value = gray + 0.3 * noise.value(noise.row((*p).x(), (*p).y()), (*p).z());
    if (std::abs(value - 0.5) < 1e-3) continue;
    CHECK(after.object->tree().isValueOn(*p) == (value > 0.5));
  }
}

TEST_CASE("scan: noise has the standard deviation and the length", "[scan]") {
  const Sample air =
      detail::described({MaskGrid::create(), nullptr}, {100, 90, 80}, detail::SourceText("air"));
  ScanOptions options;
  options.noise = 0.5;  // object is what exceeds one standard deviation
  for (const double length : {0.0, 3.0}) {
    CAPTURE(length);
    options.noiseLength = length;
    const Sample after = scanned(air, options);
    CHECK(solidFraction(after) == Approx(0.1587).margin(0.01));
    int64_t pairs = 0;
    for (auto voxel = after.object->cbeginValueOn(); voxel; ++voxel)
      pairs += after.object->tree().isValueOn(voxel.getCoord().offsetBy(3, 0, 0));
    // Two normal variables of correlation 1/e both exceed 1 in 5.1 % of cases, independent ones in
    // 2.5 %.
    CHECK(double(pairs) / (97 * 90 * 80) == Approx(length > 0 ? 0.0509 : 0.0252).margin(0.005));
  }
}

TEST_CASE("scan: grains that vanish leave no gap", "[scan]") {
  Sample sample = halfSpace(Coord(30), 8);
  for (auto voxel = sample.truth->beginValueOn(); voxel; ++voxel) voxel.setValue(*voxel + 1);
  sample.object->tree().setValueOn({15, 15, 20});
  sample.truth->tree().setValueOn({15, 15, 20}, 1);
  ScanOptions blur;
  blur.blur = 1;
  const Sample after = scanned(sample, blur);
  CHECK(labelsOf(*after.truth) == std::set<int32_t>{1, 2});
  CHECK(hash(after) == hash(halfSpace(Coord(30), 8)));
}

TEST_CASE("scan: samples without truth", "[scan]") {
  PackOptions pack;
  pack.size = {70, 64, 57};
  const Sample before = generatePack(pack), after = scanned(before, badScan());
  CHECK(!after.truth);
  CHECK(countMoved(before, after) > 1000);
  requireInsideDomain(after);
}

TEST_CASE("scan: an empty object and two voxels", "[scan]") {
  Sample empty = halfSpace(Coord(9), 0);
  ScanOptions options = badScan();
  options.noise = 0;
  CHECK(scanned(empty, options).truth->activeVoxelCount() == 0);
  const Sample two = halfSpace({2, 1, 1}, 1);
  CHECK(hash(scanned(two, options)) == hash(two));
}

TEST_CASE("scan: bad options are refused", "[scan]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Sample sample = halfSpace(Coord(5), 2);
  const auto refuses = [&](auto change) {
    ScanOptions options = badScan();
    change(options);
    CHECK_THROWS_AS(scanned(sample, options), InvalidInput);
  };
  refuses([](auto& o) { o.surface = -1; });
  refuses([&](auto& o) { o.surface = nan; });
  refuses([](auto& o) { o.surfaceLength = 0; });
  refuses([](auto& o) { o.surfaceLength = 33; });
  refuses([](auto& o) { o.blur = -1; });
  refuses([](auto& o) { o.blur = 9; });
  refuses([](auto& o) { o.noise = 1.5; });
  refuses([&](auto& o) { o.noise = nan; });
  refuses([](auto& o) { o.noiseLength = 33; });
}

TEST_CASE("scan: stops when asked to", "[scan]") {
  const Sample sample = plates();
  requireStops([&](Interrupter* stop) { return scanned(sample, badScan(), stop); });
}

TEST_CASE("scan: a ball has its volume in the gray values", "[scan]") {
  for (const double radius : {4.3, 9.0, 14.9}) {
    const Sample sample = oneBall(radius);
    const double volume = 4 / 3.0 * M_PI * std::pow(radius, 3);
    const auto sharp = grayValues(sample, {}, boxOf(sample));
    CHECK(sumOfShares(sharp) == Approx(volume).epsilon(0.001));
    CHECK(*std::min_element(sharp.begin(), sharp.end()) == 10000);
    CHECK(*std::max_element(sharp.begin(), sharp.end()) == 30000);
    ScanOptions options;
    options.blur = 0.5;
    CHECK(sumOfShares(grayValues(sample, options, boxOf(sample))) == Approx(volume).epsilon(0.001));
  }
  const Sample flat = oneBall(9, VoxelSize(std::array<double, 3>{1, 1, 2.5}));
  CHECK(2.5 * sumOfShares(grayValues(flat, {}, boxOf(flat))) ==
        Approx(4 / 3.0 * M_PI * 729).epsilon(0.001));
}

TEST_CASE("scan: what two bodies share counts once", "[scan]") {
  BallOptions options;
  options.balls = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  options.radius = 10;
  const Sample sample = generateBalls(options);
  // Two balls less the lens that they share.
  CHECK(sumOfShares(grayValues(sample, {}, boxOf(sample))) ==
        Approx(M_PI * 1000 * (8 / 3.0 - 5 / 12.0)).epsilon(0.001));
}

TEST_CASE("scan: boxes elsewhere show their part of the bodies", "[scan]") {
  BallOptions options;
  options.balls = {{0, 0, 0}, {4, 3, 0}, {0, 3, 4}, {4, 0, 4}};
  options.radius = 7;
  const Sample sample = generateBalls(options);
  const CoordBBox all = boxOf(sample);
  const Coord dim = all.dim();
  const auto whole = grayValues(sample, {}, all);
  // No ball is in the middle, or beyond.
  for (const CoordBBox& box :
       {CoordBBox({18, 16, 18}, {22, 18, 22}), CoordBBox({12, 3, 5}, {30, 20, 9}),
        CoordBBox({0, 0, 30}, {9, 9, 40}), CoordBBox(Coord(60), Coord(70))}) {
    const auto part = grayValues(sample, {}, box);
    size_t wrong = 0, i = 0;
    for (int z = box.min().z(); z <= box.max().z(); ++z)
      for (int y = box.min().y(); y <= box.max().y(); ++y)
        for (int x = box.min().x(); x <= box.max().x(); ++x)
          wrong += part[i++] != (all.isInside(Coord(x, y, z))
                                     ? whole[size_t((z * dim.y() + y) * dim.x() + x)]
                                     : 10000);
    CHECK(wrong == 0);
  }
}

TEST_CASE("scan: a plane face has the gray values of its place", "[scan]") {
  const Sample sample = oneCube();
  const auto sharp = grayValues(sample, {}, boxOf(sample));
  for (int x = 0; x < 11; ++x) CHECK(sharp[size_t(x)] == (x < 5 ? 30000 : x == 5 ? 25000 : 10000));
  ScanOptions options;
  options.blur = 1;
  const auto blurred = grayValues(sample, options, boxOf(sample));
  double sum = 0, weights[5];
  for (int k = 0; k < 5; ++k) sum += (k > 0 ? 2 : 1) * (weights[k] = std::exp(-k * k / 2.0));
  for (int x = 0; x < 11; ++x) {
    double share = 0;
    for (int k = -4; k <= 4; ++k)
      share += weights[std::abs(k)] / sum * (x + k < 5 ? 1 : x + k == 5 ? 0.75 : 0);
    CHECK(blurred[size_t(x)] == Approx(10000 + 20000 * share).margin(0.6));
  }
  // In a box elsewhere the bodies are the same.
  const auto part = grayValues(sample, options, {Coord(4, -3, 2), Coord(8, -3, 2)});
  for (int x = 4; x <= 8; ++x) CHECK(part[size_t(x - 4)] == blurred[size_t(x)]);
}

TEST_CASE("scan: gray values show the bodies of the labels", "[scan]") {
  SphereOptions spheres;
  spheres.size = Coord(56);
  spheres.count = 8;
  spheres.minRadius = 8;
  spheres.maxRadius = 11;
  SinteredOptions sintered;
  sintered.size = Coord(50);
  sintered.count = 5;
  sintered.roughness = 0.1;
  BedOptions bed;
  bed.size = Coord(40);
  bed.minRadius = 7;
  bed.maxRadius = 9;
  bed.rounds = 2;
  BedOptions balls = bed;
  balls.rounds = 0;
  ParticleOptions rods;
  rods.size = {50, 44, 40};
  rods.shape = ParticleShape::rods;
  rods.count = 8;
  rods.minRadius = rods.maxRadius = 9;
  for (const Sample& sample :
       {generateSpheres(spheres), generateSintered(sintered), generateBed(bed), generateBed(balls),
        generateParticles(rods), plates()}) {
    const CoordBBox box = boxOf(sample);
    CAPTURE(sample.object->metaValue<std::string>(kSourceKey));
    const auto gray = grayValues(sample, {}, box);
    int64_t object = 0, below = 0, above = 0;
    for (auto p = box.begin(); p; ++p) {
      const Coord dim = box.dim(), at = *p;
      const double share = shareOf(gray[size_t((at.z() * dim.y() + at.y()) * dim.x() + at.x())]);
      const bool isObject = sample.object->tree().isValueOn(at);
      object += isObject;
      below += isObject && share < 0.5;
      above += !isObject && share > 0.5;
    }
    CHECK(double(below) < 0.01 * double(object));
    CHECK(double(above) < 0.01 * double(object));
    CHECK(sumOfShares(gray) == Approx(double(object)).epsilon(0.01));
  }
}

TEST_CASE("scan: gray noise has its deviation, and is the same for any threads", "[scan]") {
  const Sample sample = oneBall(30);  // several blocks
  ScanOptions options;
  options.seed = 3;
  options.blur = 0.7;
  options.noise = 0.1;
  const auto valuesWith = [&](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return grayValues(sample, options, boxOf(sample));
  };
  const auto noisy = valuesWith(2);
  CHECK(noisy == valuesWith(1));
  options.noise = 0;
  const auto clean = grayValues(sample, options, boxOf(sample));
  double squares = 0;
  for (size_t i = 0; i < clean.size(); ++i) squares += std::pow(noisy[i] - clean[i], 2);
  CHECK(std::sqrt(squares / double(clean.size())) == Approx(2000).epsilon(0.02));
  options.noise = 1;
  const auto cut = grayValues(sample, options, boxOf(sample));
  CHECK(*std::min_element(cut.begin(), cut.end()) == 0);
  CHECK(*std::max_element(cut.begin(), cut.end()) == 65535);
}

TEST_CASE("scan: gray values that cannot be made are refused", "[scan]") {
  const Sample sample = oneBall(5);
  ScanOptions options;
  options.surface = 1;
  CHECK_THROWS_WITH(grayValues(sample, options, boxOf(sample)), Contains("surface"));
  CHECK_THROWS_WITH(grayValues(halfSpace(Coord(5), 2), {}, CoordBBox(Coord(0), Coord(4))),
                    Contains("no bodies"));
  options = {};
  options.blur = 1;
  const Sample flat = oneBall(5, VoxelSize(std::array<double, 3>{1, 1, 2}));
  CHECK_THROWS_AS(grayValues(flat, options, boxOf(flat)), InvalidInput);
  options.blur = -1;
  CHECK_THROWS_AS(grayValues(sample, options, boxOf(sample)), InvalidInput);
  StopAfter stop(0);
  CHECK_THROWS_AS(grayValues(sample, {}, boxOf(sample), &stop), Interrupted);
}
