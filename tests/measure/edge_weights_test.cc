// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/edge_weights.h"

#include <cmath>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Balls of two sizes at random places of a large cube, that do not touch.
struct Packing {
  struct Ball {
    Vec3d center;
    double radius;
  };
  static constexpr double kSmall = 3.2, kLarge = 7.4;
  std::vector<Ball> balls;

  Packing(Rng& rng, double edge, int count) {
    while (int(balls.size()) < count) {
      const Ball ball{randomPoint(rng) * edge, balls.size() % 3 ? kSmall : kLarge};
      bool isFree = true;
      for (const Ball& other : balls)
        isFree = isFree && (ball.center - other.center).length() > ball.radius + other.radius + 2;
      if (isFree) balls.push_back(ball);
    }
  }

  /// What a scan of the box shows.
  Int32Grid::Ptr cropped(const CoordBBox& box) const {
    auto labels = Int32Grid::create(0);
    for (size_t i = 0; i < balls.size(); ++i) {
      const Ball& ball = balls[i];
      CoordBBox reach(Coord::floor(ball.center - Vec3d(ball.radius)),
                      Coord::ceil(ball.center + Vec3d(ball.radius)));
      reach.intersect(box);
      for (auto p = reach.begin(); p && !reach.empty(); ++p)
        if (((*p).asVec3d() - ball.center).length() < ball.radius)
          labels->tree().setValue(*p, int32_t(i) + 1);
    }
    setDomain(*labels, box);
    return labels;
  }
};

Measurements measureWeighted(const Int32Grid& labels) {
  MeasureOptions options;
  options.edgeWeights = true;
  return measure(labels, options);
}

}  // namespace

TEST_CASE("edge_weights: the places of a box in a box, counted", "[edge_weights]") {
  Rng rng(3);
  for (int i = 0; i < 40; ++i) {
    const Coord n(rng.between(3, 9), rng.between(3, 9), rng.between(3, 9));
    const Coord origin(rng.between(-20, 20), 0, 7);
    const CoordBBox box(origin, origin + n.offsetBy(-1));
    const Coord m(rng.between(1, n.x() - 2), rng.between(1, n.y() - 2), rng.between(1, n.z() - 2));
    int whole = 0;  // of all places of its first voxel in the box
    for (auto p = box.begin(); p; ++p) {
      CoordBBox inner = box;
      inner.expand(-1);
      const CoordBBox grain(*p, *p + m.offsetBy(-1));
      const bool isWhole = inner.isInside(grain);
      whole += isWhole;
      CHECK((edgeWeight(grain, box) > 0) == isWhole);
    }
    const Coord first = origin.offsetBy(1);
    CHECK(edgeWeight({first, first + m.offsetBy(-1)}, box) ==
          Approx(double(n.x()) * n.y() * n.z() / whole));
  }
}

TEST_CASE("edge_weights: means and percentiles by weights", "[edge_weights]") {
  GrainMeasures small, large, cut;
  small.equivalentDiameter = 2;
  small.voxels = 10;
  small.volume = 10;
  small.coordination = 1;
  small.edgeWeight = 1.5;
  large.equivalentDiameter = 6;
  large.voxels = 90;
  large.volume = 90;
  large.coordination = 4;
  large.edgeWeight = 4.5;
  cut.equivalentDiameter = 100;
  cut.voxels = cut.volume = 1000;
  const std::vector<GrainMeasures> grains{cut, large, small};
  const EdgeCorrected corrected = edgeCorrected(grains);
  CHECK(corrected.leftOut == 1);
  CHECK(corrected.grains == 6);
  CHECK(corrected.meanDiameter.value() == Approx(5));
  CHECK(corrected.meanVolume.value() == Approx(70));
  CHECK(corrected.meanCoordination.value() == Approx(3.25));
  CHECK(meanDiameter(grains).value() == Approx(36));
  CHECK(correctedDiameterPercentile(grains, 0.25, false) == 2);
  CHECK(correctedDiameterPercentile(grains, 0.26, false) == 6);
  CHECK(correctedDiameterPercentile(grains, 0.035, true) == 2);  // 15 of 420
  CHECK(correctedDiameterPercentile(grains, 0.037, true) == 6);
  CHECK_FALSE(edgeCorrected({cut}).meanDiameter);
  CHECK(std::isnan(correctedDiameterPercentile({cut}, 0.5, false)));
  CHECK_FALSE(meanDiameter({}));
}

TEST_CASE("edge_weights: boxes cut out of a packing tell its sizes", "[edge_weights]") {
  // A third of the balls is large. The numbers of many boxes, each with a few balls, are added
  // up: chance then leaves some per cent.
  constexpr int kEdge = 34, kBoxes = 250;
  Rng rng(21);
  const Packing packing(rng, 190, 900);
  const double truth = (Packing::kLarge + 2 * Packing::kSmall) / 3 * 2;
  double all = 0, allDiameters = 0, whole = 0, wholeDiameters = 0, weights = 0, diameters = 0;
  for (int i = 0; i < kBoxes; ++i) {
    Coord corner;  // drawn one after another, so that each compiler draws the same
    for (const int axis : {2, 1, 0}) corner[axis] = 15 + rng.below(130);
    const Measurements measured =
        measureWeighted(*packing.cropped({corner, corner.offsetBy(kEdge - 1)}));
    for (const GrainMeasures& grain : measured.grains) {
      all += 1;
      allDiameters += grain.equivalentDiameter;
      whole += grain.edgeWeight > 0;
      wholeDiameters += grain.edgeWeight > 0 ? grain.equivalentDiameter : 0;
      weights += grain.edgeWeight;
      diameters += grain.edgeWeight * grain.equivalentDiameter;
      CHECK((grain.edgeWeight == 0) == grain.atDomainFace);
    }
  }
  const double corrected = diameters / weights;
  CAPTURE(truth, corrected, allDiameters / all, wholeDiameters / whole, whole, weights);
  CHECK(corrected == Approx(truth).epsilon(0.06));
  CHECK(std::abs(corrected - truth) < std::abs(allDiameters / all - truth) / 2);
  CHECK(std::abs(corrected - truth) < std::abs(wholeDiameters / whole - truth) / 4);
  const double expected = 900 * std::pow(kEdge / 190.0, 3) * kBoxes;  // by the density
  CHECK(weights == Approx(expected).epsilon(0.12));
}

TEST_CASE("edge_weights: refused where faces do not cut", "[edge_weights]") {
  const CoordBBox box(Coord(0), Coord(9));
  const auto labels = drawLabels({Coord(2), Coord(4)}, [](auto) { return 1; });
  CHECK_THROWS_WITH(measureWeighted(*labels), vdb_madf::test::Contains("its domain is unknown"));
  setDomain(*labels, box);
  CHECK(measureWeighted(*labels).grains.at(0).edgeWeight == Approx(std::pow(10.0 / 6, 3)));
  CHECK(measure(*labels).grains.at(0).edgeWeight == 0);
  MeasureOptions closed;
  closed.edgeWeights = true;
  closed.boundary = Boundary::closed;
  CHECK_THROWS_WITH(measure(*labels, closed), vdb_madf::test::Contains("boundary is closed"));
  MaskGrid region;
  region.fill(box, true);
  region.tree().setValueOff(Coord(9));
  setDomain(*labels, Domain(region.tree()));
  CHECK_THROWS_WITH(measureWeighted(*labels), vdb_madf::test::Contains("the domain is a region") &&
                                                  vdb_madf::test::Contains("--crop"));
}
