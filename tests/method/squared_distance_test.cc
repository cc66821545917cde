// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/squared_distance.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/method/boundary.h"

#include <algorithm>
#include <utility>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

DenseVolume<int64_t> closedDistance(const ObjectVolume& object) {
  const LeafIndex index(*toMask(object));
  return dense(index, squaredDistance(index, {}).values, object.box());
}

/// A row of voxels along an axis, and an open domain with background before its first voxel alone.
std::pair<ObjectVolume, CoordBBox> openRow(int axis, int length) {
  Coord dim(1);
  dim[axis] = length;
  const ObjectVolume object(boxAt(Coord(0), dim), 1);
  CoordBBox domain = object.box();
  --domain.min()[axis];
  return {object, domain};
}

}  // namespace

TEST_CASE("squared_distance: a cube, closed", "[squared_distance]") {
  // n voxels a side: D = (1 + distance to the nearest face)^2.
  for (const int n : {1, 2, 7, 8, 9, 20}) {
    const ObjectVolume object(boxAt({-5, 3, -8}, Coord(n)), 1);
    const DenseVolume<int64_t> distance = closedDistance(object);
    for (int i = 0; i < object.size(); ++i) {
      const Coord a = object.coord(i) - object.box().min(), b = Coord(n - 1) - a;
      const int depth = 1 + std::min({a.x(), a.y(), a.z(), b.x(), b.y(), b.z()});
      REQUIRE(distance[i] == depth * depth);
    }
  }
}

TEST_CASE("squared_distance: one background voxel in an open block", "[squared_distance]") {
  // The block fills the domain: all distances are to the hole.
  const CoordBBox box = boxAt({-3, -11, 6}, {19, 12, 30});
  for (const Coord& hole : {box.min(), box.max(), Coord(5, -4, 20)}) {
    ObjectVolume object(box, 1);
    object[hole] = 0;
    const LeafIndex index(*toMask(object));
    const SquaredDistance distance = squaredDistance(index, {true, box});
    const DenseVolume<int64_t> result = dense(index, distance.values, box);
    int64_t largest = 0;
    for (int i = 0; i < object.size(); ++i) {
      const Coord d = object.coord(i) - hole;
      const int64_t expected = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
      REQUIRE(result[i] == expected);
      largest = std::max(largest, expected);
    }
    CHECK(distance.largest == largest);
  }
}

TEST_CASE("squared_distance: a long row keeps its 32 bits", "[squared_distance][long]") {
  // Open, with background at one end only: D = n^2 at the other end, at the longest extent.
  constexpr int kLength = kMaxExtent;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [object, domain] = openRow(axis, kLength);
    const LeafIndex index(*toMask(object));
    const SquaredDistance distance = squaredDistance(index, {true, domain});
    CHECK(distance.largest == int64_t(kLength) * kLength);
    const DenseVolume<int64_t> result = dense(index, distance.values, object.box());
    for (int i = 0; i < kLength; ++i) REQUIRE(result[i] == int64_t(i + 1) * (i + 1));
  }
}

TEST_CASE("squared_distance: weights are used up to 32 bits and refused beyond",
          "[squared_distance]") {
  // Open, with background at one end only, along each axis: D = w n^2 at the other end.
  constexpr int kLength = 1000;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [object, domain] = openRow(axis, kLength);
    const LeafIndex index(*toMask(object));
    // w (1000 + 14)^2 + 2 (1 + 14)^2 < 2^31, just so.
    constexpr int kLargest = 2088;
    const auto weights = [&](int w) {
      return VoxelWeights{axis == 0 ? w : 1, axis == 1 ? w : 1, axis == 2 ? w : 1};
    };
    const SquaredDistance distance = squaredDistance(index, {true, domain}, weights(kLargest));
    CHECK(distance.largest == kLargest * kLength * kLength);
    CHECK(distance.weights == weights(kLargest));
    const DenseVolume<int64_t> result = dense(index, distance.values, object.box());
    for (int i = 0; i < kLength; ++i) REQUIRE(result[i] == int64_t(kLargest) * (i + 1) * (i + 1));
    CHECK_THROWS_AS(squaredDistance(index, {true, domain}, weights(kLargest + 1)), InvalidInput);
    CHECK_THROWS_AS(squaredDistance(index, {true, domain}, weights(0)), InvalidInput);
    CHECK_THROWS_AS(squaredDistance(index, {true, domain}, weights(-1)), InvalidInput);
  }
}

TEST_CASE("squared_distance: agrees with the oracle", "[squared_distance]") {
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    Rng rng(seed + 10000);
    const RandomCase c =
        randomCase(seed, Coord(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20)));
    const LeafIndex index(*toMask(c.object, c.tiles));
    INFO(describe(c));
    Obstacles obstacles;
    try {
      obstacles = resolveBoundary(index, c.options.boundary, c.domain);
    } catch (const InvalidInput&) {
      REQUIRE_THROWS_AS(oracleBoundary(c.object, c.options.boundary, c.domain), Undefined);
      continue;
    }
    REQUIRE(obstacles.open == oracleBoundary(c.object, c.options.boundary, c.domain));
    const VoxelWeights weights = c.options.weights.value_or(VoxelWeights{});
    const auto oracle = [&] {
      return oracleDistance(c.object, obstacles.open, obstacles.domain.box(), weights);
    };
    SquaredDistance distance;
    try {
      distance = squaredDistance(index, obstacles, weights);
    } catch (const InvalidInput&) {
      REQUIRE_THROWS_AS(oracle(), Undefined);
      continue;
    }
    const auto expected = oracle();
    REQUIRE(dense(index, distance.values, c.object.box()) == expected);
    int64_t largest = 0;
    for (int i = 0; i < c.object.size(); ++i)
      if (c.object[i]) largest = std::max(largest, expected[i]);
    REQUIRE(distance.largest == largest);
  }
}

TEST_CASE("squared_distance: permuted and mirrored axes permute and mirror it",
          "[squared_distance]") {
  Rng rng(11);
  for (int round = 0; round < 10; ++round) {
    const Coord size(rng.between(1, 30), rng.between(1, 20), rng.between(1, 10));
    const ObjectVolume object =
        randomVolume(VolumeKind::blurredNoise, boxAt(randomOrigin(rng), size), rng);
    const AxisMap map{{2, 0, 1}, {rng.chance(0.5), rng.chance(0.5), rng.chance(0.5)}};
    REQUIRE(closedDistance(permuted(object, map)) == permuted(closedDistance(object), map));
  }
}
