// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The sample as a whole.

#include <tbb/global_control.h>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/measure/measure.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

template <typename Inside>
int64_t drawnEuler(const CoordBBox& box, const Inside& inside) {
  return measure(*drawLabels(box, inside)).sample.eulerCharacteristic;
}

}  // namespace

TEST_CASE("measure_sample: Euler characteristic of known bodies", "[measure_sample]") {
  const CoordBBox box = cubeAround(14);
  const auto ball = [](const Vec3d& p) { return p.lengthSqr() < 100 ? 1 : 0; };
  const auto shell = [](const Vec3d& p) {
    return p.lengthSqr() < 100 && p.lengthSqr() > 30 ? 1 : 0;
  };
  const auto ring = [](const Vec3d& p) {
    const double d = std::hypot(p[0], p[1]) - 8;
    return d * d + p[2] * p[2] < 9 ? 1 : 0;
  };
  CHECK(drawnEuler(box, ball) == 1);
  CHECK(drawnEuler(box, shell) == 2);
  CHECK(drawnEuler(box, ring) == 0);
  // Connected by faces: voxels that share an edge or a corner are apart, ...
  CHECK(drawnEuler(
            box, [](const Vec3d& p) { return p == Vec3d(0) || p == Vec3d(1, 1, 0) ? 1 : 0; }) == 2);
  // ... and background is connected through them: this cavity has a way out.
  const auto leaky = [](const Vec3d& p) {
    return p.dot(p) <= 3 && p != Vec3d(0) && p != Vec3d(1, 1, 1) && p[0] * p[0] <= 1 &&
                   p[1] * p[1] <= 1 && p[2] * p[2] <= 1
               ? 1
               : 0;
  };
  CHECK(drawnEuler(box, leaky) == 1);
}

TEST_CASE("measure_sample: layers correlate along themselves", "[measure_sample]") {
  // Layers 10 thick, 10 apart, across y: S(r) = 1/2 - r/20, the correlation 1 - r/5.
  const CoordBBox box = boxAt(Coord(0), Coord(40, 400, 40));
  auto labels = drawLabels(box, [](const Vec3d& p) { return int(p[1]) % 20 < 10 ? 1 : 0; });
  setDomain(*labels, box);
  const SampleMeasures sample = measure(*labels).sample;
  CHECK(sample.domainKnown);
  CHECK(sample.objectFraction == 0.5);
  CHECK(sample.correlationLengths[1].value() == Approx(5 * (1 - std::exp(-1.0))).epsilon(0.02));
  CHECK_FALSE(sample.correlationLengths[0].has_value());
  CHECK_FALSE(sample.correlationLengths[2].has_value());
  CHECK(sample.components == 20);
}

TEST_CASE("measure_sample: fabric, coordination and sizes of a chain", "[measure_sample]") {
  // Five boxes in a row along z, each longest along x.
  const CoordBBox box = boxAt(Coord(0), Coord(24, 8, 50));
  const auto labels = drawLabels(box, [](const Vec3d& p) { return 1 + int(p[2]) / 10; });
  const Measurements m = measure(*labels);
  const SampleMeasures& sample = m.sample;
  CHECK(sample.coordinations == std::vector<int64_t>{0, 2, 3});
  CHECK(sample.meanCoordination == Approx(8.0 / 5));
  CHECK(sample.components == 1);
  CHECK(sample.grainFabric.components[0] == Approx(1));
  CHECK(sample.grainFabric.principal.values[0] == Approx(1));
  CHECK(sample.grainFabric.principal.values[1] == Approx(0).margin(1e-12));
  CHECK(sample.bondFabric.components[2] == Approx(1));
  CHECK(sample.bondFabric.principal.axes[0] == Vec3d(0, 0, 1));
  const double diameter = std::cbrt(6 * 24 * 8 * 10 / M_PI);
  CHECK(diameterPercentile(m.grains, 0.5, false) == Approx(diameter));
  double radii = 0;
  for (const BondMeasures& bond : m.bonds) radii += bond.equivalentRadius / 4;
  CHECK(sample.bondToGrainRatio.value() == Approx(2 * radii / diameter));
  CHECK(sample.sharedArea == Approx(4 * 24 * 8).epsilon(0.1));
  CHECK_FALSE(sample.domainKnown);
  CHECK(sample.box == box);
}

TEST_CASE("measure_sample: percentiles by number and by volume", "[measure_sample]") {
  // Edges 1 (eight times), 3 and 8.
  auto labels = Int32Grid::create(0);
  for (int i = 0; i < 8; ++i) labels->tree().setValue(Coord(20 + 2 * i, 0, 0), 10 + i);
  labels->fill(CoordBBox(Coord(0), Coord(2)), 2);
  labels->fill(CoordBBox(Coord(5), Coord(12)), 1);
  const auto grains = measure(*labels).grains;
  REQUIRE(grains.size() == 10);
  const double unit = std::cbrt(6 / M_PI);
  CHECK(diameterPercentile(grains, 0.5, false) == Approx(unit));
  CHECK(diameterPercentile(grains, 0.9, false) == Approx(3 * unit));
  CHECK(diameterPercentile(grains, 0.95, false) == Approx(8 * unit));
  CHECK(diameterPercentile(grains, 0.05, true) == Approx(3 * unit));  // 35 of 547 up to edge 3
  CHECK(diameterPercentile(grains, 0.5, true) == Approx(8 * unit));
  CHECK(diameterPercentile({}, 0.5, true) == 0);
}

TEST_CASE("measure_sample: specific surface of a ball", "[measure_sample]") {
  const auto labels =
      drawLabels(cubeAround(20), [](const Vec3d& p) { return p.lengthSqr() < 320 ? 1 : 0; });
  const SampleMeasures sample = measure(*labels).sample;
  CHECK(sample.specificSurface == Approx(3 / std::sqrt(320.0)).epsilon(0.01));
  CHECK(sample.freeArea / double(sample.objectVoxels) == Approx(sample.specificSurface));
}

TEST_CASE("measure_sample: a segmentation measures as its labels do", "[measure_sample][long]") {
  Rng rng(7);
  bool wasFiltered = false;
  for (const int64_t gamma : {0, 1, 8})
    for (const Boundary boundary : {Boundary::open, Boundary::closed})
      for (const VolumeKind kind : {VolumeKind::blurredNoise, VolumeKind::denseNoise}) {
        const ObjectVolume object = randomVolume(kind, CoordBBox(Coord(-9), Coord(30)), rng);
        SegmentOptions options;
        options.gamma = gamma;
        options.boundary = boundary;
        options.merge.strictness = 14;  // noise has many grains then
        options.domain = CoordBBox(Coord(-9), Coord(30));
        // Plain labels are measured with the help of their graph.
        if (kind == VolumeKind::denseNoise) options.fillHoles = options.tidy = 0;
        const Segmentation grains = segment(*toMask(object), options);
        wasFiltered = wasFiltered || grains.counts.keptBalls < grains.counts.medialBalls;
        const Measurements a = measure(grains), b = measure(*grains.grain);
        CAPTURE(gamma, int(boundary), int(kind));
        REQUIRE(a.grains.size() == b.grains.size());
        REQUIRE(a.bonds.size() == b.bonds.size());
        REQUIRE(a.grains.size() > 3);
        for (size_t i = 0; i < a.grains.size(); ++i) {
          REQUIRE(a.grains[i].representative.has_value());
          CHECK(a.grains[i].representative == b.grains[i].representative);
          CHECK(a.grains[i].inscribedRadius == b.grains[i].inscribedRadius);
          CHECK(a.grains[i].cutArea == b.grains[i].cutArea);
        }
        for (size_t i = 0; i < a.bonds.size(); ++i) {
          CHECK(a.bonds[i].distance == b.bonds[i].distance);
          CHECK(a.bonds[i].cosAlpha == b.bonds[i].cosAlpha);
        }
      }
  CHECK(wasFiltered);
}

TEST_CASE("measure_sample: the same bits with one thread and with four", "[measure_sample]") {
  Rng rng(1);
  const ObjectVolume object =
      randomVolume(VolumeKind::blurredNoise, CoordBBox(Coord(0), Coord(71)), rng);
  SegmentOptions options;
  // The deepest voxel of each grain is then its representative.
  options.fillHoles = options.tidy = 0;
  const Segmentation grains = segment(*toMask(object), options);
  std::vector<Measurements> results;
  for (const size_t threads : {1, 4, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(measure(*grains.grain));
  }
  const Measurements& a = results[0];
  REQUIRE(a.bonds.size() > 20);
  for (size_t k = 1; k < results.size(); ++k) {
    const Measurements& b = results[k];
    REQUIRE(a.grains.size() == b.grains.size());
    REQUIRE(a.bonds.size() == b.bonds.size());
    for (size_t i = 0; i < a.grains.size(); ++i) {
      CHECK(a.grains[i].freeArea == b.grains[i].freeArea);
      CHECK(a.grains[i].centroid == b.grains[i].centroid);
      CHECK(a.grains[i].ellipsoid.axes == b.grains[i].ellipsoid.axes);
      CHECK(a.grains[i].representative == b.grains[i].representative);
    }
    for (size_t i = 0; i < a.bonds.size(); ++i) {
      CHECK(a.bonds[i].area == b.bonds[i].area);
      CHECK(a.bonds[i].flatness == b.bonds[i].flatness);
      if (a.bonds[i].curvature) CHECK(a.bonds[i].curvature->mean == b.bonds[i].curvature->mean);
    }
    CHECK(a.sample.correlationLengths == b.sample.correlationLengths);
    CHECK(a.sample.grainFabric.components == b.sample.grainFabric.components);
  }
  // The representatives are those that the segmentation numbered the grains by.
  for (size_t i = 1; i < a.grains.size(); ++i)
    CHECK(a.grains[i - 1].representative.value() < a.grains[i].representative.value());
}
