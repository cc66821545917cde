// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What segment() must do alike on voxels of several shapes: no oracle. That permuted axes permute
// the weights, and mirrors keep them, is in segment_metamorphic_test.cc.

#include <cmath>

#include "support/catch.h"
#include "support/grid_values.h"
#include "support/invariants.h"
#include "support/random_case.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

Segmentation segmentKeepingAll(const ObjectVolume& object, SegmentOptions options) {
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = true;
  return segment(*toMask(object), options);
}

/// p in the volume of which every k-th slice along an axis was taken.
Coord inFine(Coord p, int axis, int k) {
  p[axis] *= k;
  return p;
}

/// Every k-th slice of a fine volume along an axis.
ObjectVolume sampled(const ObjectVolume& fine, int axis, int k) {
  Coord size = fine.box().dim();
  size[axis] = (size[axis] + k - 1) / k;
  ObjectVolume result(boxAt(Coord(0), size));
  for (int i = 0; i < result.size(); ++i) result[i] = fine[inFine(result.coord(i), axis, k)];
  return result;
}

/// Every slice k times.
ObjectVolume stretched(const ObjectVolume& coarse, int axis, int k) {
  Coord size = coarse.box().dim();
  size[axis] *= k;
  ObjectVolume result(boxAt(Coord(0), size));
  for (int i = 0; i < result.size(); ++i) {
    Coord p = result.coord(i);
    p[axis] /= k;
    result[i] = coarse[p];
  }
  return result;
}

/// 1 : 1 : k^2, the k^2 along that axis.
VoxelWeights longAlong(int axis, int k) {
  return {axis == 0 ? k * k : 1, axis == 1 ? k * k : 1, axis == 2 ? k * k : 1};
}

SegmentOptions closed() {
  SegmentOptions options;
  options.boundary = Boundary::closed;
  options.fillHoles = 0;
  return options;
}

constexpr VolumeKind kKinds[] = {VolumeKind::blurredNoise, VolumeKind::roughBalls,
                                 VolumeKind::denseNoise, VolumeKind::boxUnion,
                                 VolumeKind::hollowShell};

}  // namespace

TEST_CASE("weights: a common factor scales squared lengths and changes no label", "[weights]") {
  // A power of two: cosines are then the same to the last bit, too. The kernels for cubes are
  // others than those with weights, so this compares the two.
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Rng rng(seed);
    RandomCase c = randomCase(seed);
    c.object = randomVolume(
        kKinds[seed % 5],
        boxAt(Coord(-3), {rng.between(1, 45), rng.between(1, 45), rng.between(1, 45)}), rng);
    c.options.boundary = Boundary::closed;
    c.options.weights.reset();
    INFO(describe(c));
    const CoordBBox box = c.object.box();
    const Segmentation cubes = segmentKeepingAll(c.object, c.options);
    for (const int factor : {2, 64}) {
      c.options.weights = VoxelWeights{factor, factor, factor};
      const Segmentation s = segmentKeepingAll(c.object, c.options);
      REQUIRE(valuesIn(*s.grain, box) == valuesIn(*cubes.grain, box));
      REQUIRE(valuesIn(*s.manifold, box) == valuesIn(*cubes.manifold, box));
      REQUIRE(valuesIn(*s.power, box) == valuesIn(*cubes.power, box, factor));
      REQUIRE(valuesIn(*s.distanceSquared, box) == valuesIn(*cubes.distanceSquared, box, factor));
      REQUIRE(s.balls.size() == cubes.balls.size());
      for (size_t i = 0; i < s.balls.size(); ++i) {
        REQUIRE(s.balls[i].center == cubes.balls[i].center);
        REQUIRE(s.balls[i].squaredRadius == factor * cubes.balls[i].squaredRadius);
        REQUIRE(s.balls[i].cellSize == cubes.balls[i].cellSize);
      }
    }
  }
}

TEST_CASE("weights: every k-th slice knows a part of the background", "[weights]") {
  // Lengths between slices are those in the fine volume, and the background voxels in them are some
  // of its own: so D of the slices is at least D of the fine volume. It is the same where the
  // object does not change along the axis: the nearest background then lies in the voxel's own
  // slice.
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Rng rng(seed + 50);
    const int k = rng.between(2, 5), axis = rng.below(3);
    Coord size(rng.between(3, 14), rng.between(3, 14), rng.between(3, 14));
    size[axis] *= k;
    const ObjectVolume fine = randomVolume(kKinds[seed % 5], boxAt(Coord(0), size), rng);
    const ObjectVolume coarse = sampled(fine, axis, k);
    SegmentOptions options = closed();
    const Segmentation slow = segmentKeepingAll(fine, options);
    options.weights = longAlong(axis, k);
    const Segmentation quick = segmentKeepingAll(coarse, options);
    CAPTURE(seed, k, axis);
    const auto all = valuesIn(*slow.distanceSquared, fine.box());
    const auto some = valuesIn(*quick.distanceSquared, coarse.box());
    for (int i = 0; i < coarse.size(); ++i)
      REQUIRE(some[i] >= all[inFine(coarse.coord(i), axis, k)]);
  }
}

TEST_CASE("weights: a stretched volume has the same distances, to less than a slice", "[weights]") {
  // Every slice k times instead of k times as thick. The nearest background of a voxel in the first
  // slice of its k lies in the same column, at most k - 1 slices nearer; the norm changes by at
  // most as much: sqrt(D) - (k - 1) <= sqrt(D of the stretched) <= sqrt(D).
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Rng rng(seed + 150);
    const int k = rng.between(2, 5), axis = rng.below(3);
    const Coord size(rng.between(3, 14), rng.between(3, 14), rng.between(3, 14));
    const ObjectVolume coarse = randomVolume(kKinds[seed % 5], boxAt(Coord(0), size), rng);
    const ObjectVolume fine = stretched(coarse, axis, k);
    SegmentOptions options = closed();
    // The background outside begins one coarse voxel away: with the volume's own walls.
    CoordBBox walls = coarse.box();
    walls.expand(1);
    options.boundary = Boundary::open;
    options.domain = walls;
    options.weights = longAlong(axis, k);
    const Segmentation quick = segmentKeepingAll(coarse, options);
    walls = fine.box();
    walls.expand(k);
    options.domain = walls;
    options.weights.reset();
    const Segmentation slow = segmentKeepingAll(fine, options);
    CAPTURE(seed, k, axis);
    const auto thick = valuesIn(*quick.distanceSquared, coarse.box());
    const auto thin = valuesIn(*slow.distanceSquared, fine.box());
    for (int i = 0; i < coarse.size(); ++i) {
      const int64_t d = thick[i], e = thin[inFine(coarse.coord(i), axis, k)];
      REQUIRE(e <= d);
      REQUIRE(std::sqrt(double(d)) <= std::sqrt(double(e)) + (k - 1) + 1e-9);
    }
  }
}

TEST_CASE("weights: along a prism slices are alike, however thick", "[weights]") {
  // Open at both ends, the object the same in all slices: D is that of a slice, and the ball of
  // least power lies in the voxel's own slice, for in another one it has the same D and is farther.
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Rng rng(seed + 250);
    const int k = rng.between(2, 5), axis = rng.below(3);
    Coord size(rng.between(3, 24), rng.between(3, 24), rng.between(3, 24));
    size[axis] = 1;
    const ObjectVolume slice = randomVolume(kKinds[seed % 5], boxAt(Coord(0), size), rng);
    if (countObject(slice) == slice.size()) continue;
    const ObjectVolume coarse = stretched(slice, axis, 4), fine = stretched(slice, axis, 4 * k);
    SegmentOptions options = closed();
    options.boundary = Boundary::open;
    options.domain = fine.box();
    const Segmentation slow = segmentKeepingAll(fine, options);
    options.domain = coarse.box();
    options.weights = longAlong(axis, k);
    const Segmentation quick = segmentKeepingAll(coarse, options);
    CAPTURE(seed, k, axis);
    REQUIRE(anyViolation(quick, *toMask(coarse), 0) == "");
    for (const auto& [thick, thin] : {std::pair(quick.distanceSquared, slow.distanceSquared),
                                      std::pair(quick.power, slow.power)}) {
      const auto some = valuesIn(*thick, coarse.box()), all = valuesIn(*thin, fine.box());
      for (int i = 0; i < coarse.size(); ++i)
        REQUIRE(some[i] == all[inFine(coarse.coord(i), axis, k)]);
    }
    REQUIRE(k * quick.counts.criticalPoints == slow.counts.criticalPoints);
    REQUIRE(k * quick.counts.medialBalls == slow.counts.medialBalls);
  }
}
