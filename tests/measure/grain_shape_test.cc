// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Convex hulls of grains: bodies whose hulls are known, and the definitions by brute force.

#include "vdb_madf/measure/grain_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

Measurements measureShape(const Int32Grid& labels) {
  MeasureOptions options;
  options.shape = true;
  return measure(labels, options);
}

/// Of a single grain.
GrainShape shapeOf(const Int32Grid& labels) {
  return measureShape(labels).grains.at(0).shape.value();
}

std::vector<Vec3d> cornersOf(const Int32Grid& labels, const Vec3d& edges) {
  std::vector<Vec3d> corners;
  for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel)
    for (int k = 0; k < 8; ++k)
      corners.push_back((voxel.getCoord() + Coord(k & 1, k >> 1 & 1, k >> 2)).asVec3d() * edges);
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// The least extent along any direction across two of the differences of the points: planes that
/// hold a facet lie across two of its sides, planes that hold an edge each across these two.
double leastWidth(const std::vector<Vec3d>& points) {
  std::vector<Vec3d> differences;
  for (const Vec3d& a : points)
    for (const Vec3d& b : points) {
      Vec3d difference = b - a;
      if (!(Vec3d(0) < difference) || !difference.normalize()) continue;
      const bool isKnown =
          std::any_of(differences.begin(), differences.end(),
                      [&](const Vec3d& known) { return (known - difference).length() < 1e-9; });
      if (!isKnown) differences.push_back(difference);
    }
  double least = std::numeric_limits<double>::max();
  for (const Vec3d& a : differences)
    for (const Vec3d& b : differences) {
      Vec3d normal = a.cross(b);
      if (normal.length() < 1e-9) continue;
      normal.normalize();
      double low = std::numeric_limits<double>::max(), high = -low;
      for (const Vec3d& point : points) {
        low = std::min(low, normal.dot(point));
        high = std::max(high, normal.dot(point));
      }
      least = std::min(least, high - low);
    }
  return least;
}

double largestDistance(const std::vector<Vec3d>& points) {
  double largest = 0;
  for (const Vec3d& a : points)
    for (const Vec3d& b : points) largest = std::max(largest, (a - b).length());
  return largest;
}

Int32Grid::Ptr scattered(Rng& rng, const Coord& origin, int voxels) {
  auto grid = Int32Grid::create(0);
  for (int i = 0; i < voxels; ++i)
    grid->tree().setValue(origin + Coord(rng.below(4), rng.below(3), rng.below(3)), 1);
  return grid;
}

}  // namespace

TEST_CASE("grain_shape: a voxel, a rod, a plate and a brick", "[grain_shape]") {
  for (const Vec3d edges : {Vec3d(1), Vec3d(1, 1.5, 2)})
    for (const Coord size :
         {Coord(1), Coord(1, 1, 30), Coord(17, 1, 1), Coord(20, 1, 12), Coord(9, 16, 7)}) {
      CAPTURE(edges, size);
      const Coord first(-5, 3, 6);
      const auto labels =
          drawLabels({first, first + size.offsetBy(-1)}, [](const Vec3d&) { return 3; });
      setProportions(*labels, {edges[0], edges[1], edges[2]});
      const Measurements measured = measureShape(*labels);
      const GrainMeasures& grain = measured.grains.at(0);
      const Vec3d lengths = size.asVec3d() * edges;
      CHECK(grain.shape->maxFeret == Approx(lengths.length()).epsilon(1e-12));
      CHECK(grain.shape->minFeret ==
            Approx(std::min({lengths[0], lengths[1], lengths[2]})).epsilon(1e-12));
      CHECK(grain.shape->convexVolume ==
            Approx(lengths[0] * lengths[1] * lengths[2]).epsilon(1e-12));
      CHECK(grain.solidity() == Approx(1).epsilon(1e-12));
      const double quarter =
          (lengths[0] * lengths[1] + lengths[1] * lengths[2] + lengths[2] * lengths[0]) / 2;
      CHECK(grain.shape->projectedDiameter == Approx(2 * std::sqrt(quarter / M_PI)).epsilon(1e-12));
    }
}

TEST_CASE("grain_shape: a corner of three rods", "[grain_shape]") {
  // Corner voxel and n - 1 more along each axis.
  constexpr int n = 10;
  auto labels = Int32Grid::create(0);
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < n; ++i) {
      Coord voxel(0);
      voxel[axis] = i;
      labels->tree().setValue(voxel, 1);
    }
  const GrainShape shape = shapeOf(*labels);
  // The farthest corners: (n, 1, 0) and (0, 0, n) among others.
  CHECK(shape.maxFeret == Approx(std::sqrt(2.0 * n * n + 1)));
  const auto corners = cornersOf(*labels, Vec3d(1));
  CHECK(shape.minFeret == Approx(leastWidth(corners)));
}

TEST_CASE("grain_shape: the definitions by brute force on a few voxels", "[grain_shape]") {
  for (int seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    Rng rng{uint64_t(seed)};
    const auto labels = scattered(rng, Coord(6, -2, 1022), rng.between(2, 5));
    const Vec3d edges = seed % 3 ? Vec3d(1) : Vec3d(1, 1.3, 1.7);
    setProportions(*labels, {edges[0], edges[1], edges[2]});
    const auto corners = cornersOf(*labels, edges);
    const GrainShape shape = shapeOf(*labels);
    CHECK(shape.maxFeret == Approx(largestDistance(corners)).epsilon(1e-12));
    CHECK(shape.minFeret == Approx(leastWidth(corners)).epsilon(1e-9));
    CHECK(shape.minFeret <= shape.maxFeret);
  }
}

TEST_CASE("grain_shape: a ball", "[grain_shape]") {
  constexpr double r = 15.2;
  const auto labels = drawLabels(cubeAround(r + 2), [](const Vec3d& p) { return p.length() < r; });
  const Measurements measured = measureShape(*labels);
  const GrainMeasures& grain = measured.grains.at(0);
  CHECK(grain.shape->maxFeret == Approx(2 * r + 0.8).margin(1.2));
  CHECK(grain.shape->minFeret == Approx(2 * r).margin(1));
  CHECK(grain.solidity() > 0.9);
  CHECK(grain.solidity() < 1);
  CHECK(zinggClass(grain.ellipsoid.values) == 2);
}

TEST_CASE("grain_shape: parts of a grain have a common hull, other grains none of it",
          "[grain_shape]") {
  auto labels = Int32Grid::create(0);
  labels->tree().setValue(Coord(0), 5);
  labels->tree().setValue(Coord(100, 0, 0), 5);
  labels->tree().setValue(Coord(50, 50, 50), 2);
  const Measurements measured = measureShape(*labels);
  CHECK(measured.grains.at(0).shape->convexVolume == Approx(1));
  CHECK(measured.grains.at(1).shape->convexVolume == Approx(101));
  CHECK(measured.grains.at(1).solidity() == Approx(2.0 / 101));
  CHECK_FALSE(measure(*labels).grains.at(0).shape);
  CHECK(measureShape(*Int32Grid::create(0)).grains.empty());
}

TEST_CASE("grain_shape: turned and shifted grains have the same shape", "[grain_shape]") {
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, CoordBBox(Coord(0), Coord(22, 25, 19)), rng);
  const auto drawn = [&](const std::array<int, 3>& axes, const Coord& shift) {
    auto labels = Int32Grid::create(0);
    for (auto p = CoordBBox(Coord(0), Coord(22, 25, 19)).begin(); p; ++p) {
      const Coord at(shift + Coord((*p)[axes[0]], (*p)[axes[1]], (*p)[axes[2]]));
      if (object[*p]) labels->tree().setValue(at, 1);
    }
    return shapeOf(*labels);
  };
  const GrainShape shape = drawn({0, 1, 2}, Coord(0));
  for (const auto& other :
       {drawn({1, 2, 0}, Coord(0)), drawn({2, 1, 0}, Coord(3, -5, 7)),
        drawn({0, 1, 2}, Coord(1, 1, 1)), drawn({0, 1, 2}, Coord(-1000003, 9, 4000))}) {
    CHECK(other.maxFeret == Approx(shape.maxFeret).epsilon(1e-12));
    CHECK(other.minFeret == Approx(shape.minFeret).epsilon(1e-12));
    CHECK(other.convexVolume == Approx(shape.convexVolume).epsilon(1e-12));
  }
}

TEST_CASE("grain_shape: Zingg's classes", "[grain_shape]") {
  CHECK(zinggClass({9, 8, 2}) == 1);  // disc
  CHECK(zinggClass({9, 8, 7}) == 2);  // equant
  CHECK(zinggClass({9, 4, 2}) == 3);  // blade
  CHECK(zinggClass({9, 4, 3}) == 4);  // rod
  CHECK(zinggClass({9, 6, 4}) == 3);  // two thirds are not above two thirds
  CHECK(zinggClass({9, 6, 4.1}) == 4);
  CHECK(zinggClass({9, 6.1, 4}) == 1);
}
