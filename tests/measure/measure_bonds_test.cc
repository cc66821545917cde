// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The table of bonds: interfaces whose measures are known. Areas: leaf_surface_test.cc.

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

BondMeasures onlyBond(const Int32Grid& labels) {
  MeasureOptions options;
  options.bondRadii = true;
  const std::vector<BondMeasures> bonds = measure(labels, options).bonds;
  REQUIRE(bonds.size() == 1);
  return bonds[0];
}

}  // namespace

TEST_CASE("measure_bonds: the disc between two balls", "[measure_bonds]") {
  Rng rng(31);
  for (int i = 0; i < 10; ++i) {
    TwoBalls balls;
    balls.radius = 10 + 3 * rng.unit();
    balls.first = balls.radius * (1.1 + 0.3 * rng.unit());
    balls.second = balls.radius * (1.1 + 0.3 * rng.unit());
    balls.center = randomPoint(rng);
    balls.normal = randomDirection(rng);
    const BondMeasures bond = onlyBond(*drawLabels(balls.box(), balls));
    CAPTURE(i, balls.normal);
    CHECK(bond.first == 1);
    CHECK(bond.second == 2);
    CHECK(bond.equivalentRadius == Approx(balls.radius).epsilon(0.04));
    CHECK(bond.equivalentRadius == Approx(std::sqrt(bond.area / M_PI)));
    CHECK((bond.centroid - balls.center).length() < 0.8);
    CHECK(bond.normal.length() == Approx(1));
    CHECK(bond.normal.dot(balls.normal) > 0.995);
    CHECK(bond.patches == 1);
    CHECK(bond.inscribedRadius.value() == Approx(balls.radius).margin(1));
    // A plane but for the voxels' steps, of at most half a voxel and a mean square of a twelfth.
    CHECK(bond.flatness < 0.3);
    REQUIRE(bond.curvature.has_value());
    CHECK(std::abs(bond.curvature->mean) < 0.02);
    CHECK(std::abs(bond.curvature->gaussian) < 0.002);
    CHECK(bond.curvature->residual < 0.5);
    // The deepest voxels are the centers, or nearly so.
    const double distance = balls.firstOffset() + balls.secondOffset();
    CHECK(bond.distance.value() == Approx(distance).margin(2));
    const double a = balls.first, b = balls.second;
    CHECK(bond.cosAlpha.value() ==
          Approx((distance * distance - a * a - b * b) / (2 * a * b)).margin(0.25));
  }
}

TEST_CASE("measure_bonds: representatives, distance and angle to the digit", "[measure_bonds]") {
  // Two cubes of edge 5 side by side: centers 5 apart, D = 3^2.
  const auto labels =
      drawLabels({Coord(0), Coord(9, 4, 4)}, [](const Vec3d& p) { return p[0] < 5 ? 1 : 2; });
  const Measurements m = measure(*labels);
  CHECK(m.grains[0].representative.value() == Coord(2, 2, 2));
  CHECK(m.grains[1].representative.value() == Coord(5, 2, 2));  // the first of three
  CHECK(m.grains[0].inscribedRadius == 3);
  const BondMeasures& bond = m.bonds.at(0);
  CHECK(bond.distance.value() == 3);
  CHECK(bond.cosAlpha.value() == (9.0 - 9 - 9) / (2 * 9));
  CHECK(bond.faces == 25);
  CHECK(bond.centroid == Vec3d(4.5, 2, 2));
  CHECK(bond.normal == Vec3d(1, 0, 0));
  CHECK(bond.flatness == 0);
  CHECK(bond.curvature->mean == Approx(0).margin(1e-12));
  CHECK(bond.curvature->residual == Approx(0).margin(1e-12));
}

TEST_CASE("measure_bonds: curvature and flatness of a ball within a grain", "[measure_bonds]") {
  for (const double radius : {11.0, 16.0}) {
    for (const bool ballIsFirst : {true, false}) {
      const auto labels = drawLabels(cubeAround(radius + 4), [&](const Vec3d& p) {
        return (p.lengthSqr() < radius * radius) == ballIsFirst ? 1 : 2;
      });
      const BondMeasures bond = onlyBond(*labels);
      CAPTURE(radius, ballIsFirst);
      CHECK(bond.area == Approx(4 * M_PI * radius * radius).epsilon(0.03));
      // Points spread evenly over a sphere: r^2 / 3 along any axis.
      CHECK(bond.flatness == Approx(radius * radius / 3).epsilon(0.03));
      CHECK(bond.normal.length() == Approx(1));  // though the faces' normals cancel
      CHECK(bond.patches == 1);
      const double sign = ballIsFirst ? 1 : -1;
      CHECK(bond.curvature->mean == Approx(sign / radius).epsilon(0.15));
      CHECK(bond.curvature->gaussian == Approx(1 / (radius * radius)).epsilon(0.3));
      CHECK(bond.curvature->meanDeviation < 0.5 / radius);
    }
  }
}

TEST_CASE("measure_bonds: how curvatures spread over an interface", "[measure_bonds]") {
  // Two balls within a grain, of radius 8 and 16: points are taken evenly, a fifth from the small.
  const auto labels = drawLabels({Coord(-18, -18, -18), Coord(40, 18, 18)}, [](const Vec3d& p) {
    return p.lengthSqr() < 16 * 16 || (p - Vec3d(29, 0, 0)).lengthSqr() < 8 * 8 ? 1 : 2;
  });
  const InterfaceCurvature curvature = onlyBond(*labels).curvature.value();
  CHECK(onlyBond(*labels).patches == 2);
  CHECK(curvature.points == 32);
  CHECK(curvature.mean == Approx(0.2 / 8 + 0.8 / 16).epsilon(0.1));
  // From the two radii alone 0.025; the fits themselves spread as much.
  CHECK(curvature.meanDeviation > 0.4 * (1.0 / 8 - 1.0 / 16));
  CHECK(curvature.meanDeviation < 2 * 0.4 * (1.0 / 8 - 1.0 / 16));
  CHECK(curvature.gaussian == Approx(0.2 / 64 + 0.8 / 256).epsilon(0.2));
  CHECK(curvature.gaussianDeviation == Approx(0.4 * (1.0 / 64 - 1.0 / 256)).epsilon(0.4));
  // The voxels' steps: of height 1 or less, spread evenly.
  CHECK(curvature.residual < std::sqrt(1.0 / 12));
  CHECK(curvature.residual > 0.5 * std::sqrt(1.0 / 12));
}

TEST_CASE("measure_bonds: curvature of a saddle", "[measure_bonds]") {
  constexpr double kRadius = 16;  // of both principal curvatures, at the center
  const auto labels = drawLabels(cubeAround(10), [&](const Vec3d& p) {
    if (p[0] * p[0] + p[1] * p[1] > 36) return 0;
    return p[2] < (p[0] * p[0] - p[1] * p[1]) / (2 * kRadius) + 0.2 ? 1 : 2;
  });
  const BondMeasures bond = onlyBond(*labels);
  CHECK(bond.curvature->mean == Approx(0).margin(0.015));
  CHECK(bond.curvature->gaussian < -0.4 / (kRadius * kRadius));
  CHECK(bond.curvature->gaussian > -1.6 / (kRadius * kRadius));
  CHECK(std::abs(bond.normal[2]) > 0.99);
}

TEST_CASE("measure_bonds: patches", "[measure_bonds]") {
  // Two bars joined by feet: 1 below, 2 above.
  const auto feet = [](int count, int gap) {
    return drawLabels({Coord(0), Coord(4 * count + gap * count, 3, 11)}, [=](const Vec3d& p) {
      const bool inFoot = int(p[0]) % (4 + gap) < 4 && p[0] < (4 + gap) * count;
      if (p[2] < 4) return 1;
      if (p[2] > 7) return 2;
      return !inFoot ? 0 : p[2] < 6 ? 1 : 2;
    });
  };
  CHECK(onlyBond(*feet(1, 3)).patches == 1);
  CHECK(onlyBond(*feet(2, 3)).patches == 2);
  CHECK(onlyBond(*feet(5, 1)).patches == 5);
  CHECK(onlyBond(*feet(5, 1)).faces == 5 * 16);
  // Faces that meet in a corner only are one patch.
  auto corner = Int32Grid::create(0);
  for (const Coord& p : {Coord(0, 0, 0), Coord(1, 1, 0), Coord(0, 1, 0), Coord(1, 0, 0)}) {
    corner->tree().setValue(p, 1);
    if (p.x() == p.y()) corner->tree().setValue(p + Coord(0, 0, 1), 2);
  }
  CHECK(onlyBond(*corner).faces == 2);
  CHECK(onlyBond(*corner).patches == 1);
}

TEST_CASE("measure_bonds: contacts of too few faces are left out, their areas are not",
          "[measure_bonds]") {
  // 1 and 2 share 16 faces; 3 stands on 2 with a foot of one voxel.
  const auto labels = drawLabels({Coord(0), Coord(7, 3, 8)}, [](const Vec3d& p) {
    if (p[2] < 4) return p[0] < 4 ? 1 : 2;
    return p[2] > 4 || p == Vec3d(5, 1, 4) ? 3 : 0;
  });
  const Measurements all = measure(*labels);
  CHECK(all.bonds.size() == 2);
  CHECK(all.sample.contactsLeftOut == 0);
  CHECK(all.sample.areaLeftOut == 0);
  CHECK(all.sample.bondsWithoutCurvature == 1);
  MeasureOptions options;
  for (const int64_t minFaces : {0, 1, 2, 16, 17}) {
    CAPTURE(minFaces);
    options.minFaces = minFaces;
    const Measurements some = measure(*labels, options);
    const size_t bonds = minFaces < 2 ? 2 : minFaces < 17 ? 1 : 0;
    CHECK(some.minFaces == minFaces);
    REQUIRE(some.bonds.size() == bonds);
    CHECK(some.sample.contactsLeftOut == int64_t(2 - bonds));
    if (bonds > 0) CHECK(some.bonds[0].faces == 16);
    CHECK(some.sample.meanCoordination == Approx(2.0 * double(bonds) / 3));
    CHECK(some.grains[1].coordination == int(bonds));
    CHECK(some.grains[2].coordination == (bonds == 2 ? 1 : 0));
    CHECK(some.sample.bondsWithoutCurvature == (bonds == 2 ? 1 : 0));
    if (bonds == 1)
      CHECK(some.sample.bondToGrainRatio.value() ==
            Approx(2 * all.bonds[0].equivalentRadius / all.grains[0].equivalentDiameter));
    CHECK(some.sample.bondToGrainRatio.has_value() == (bonds > 0));
    double area = some.sample.areaLeftOut;
    for (const BondMeasures& bond : some.bonds) area += bond.area;
    CHECK(area == Approx(all.sample.sharedArea));
    CHECK(some.sample.sharedArea == Approx(all.sample.sharedArea));
    CHECK(some.sample.freeArea == all.sample.freeArea);
    for (size_t i = 0; i < 3; ++i) {
      CHECK(some.grains[i].sharedArea == all.grains[i].sharedArea);
      CHECK(some.grains[i].sphericity == all.grains[i].sphericity);
    }
  }
  options.minFaces = -1;
  CHECK_THROWS_AS(measure(*labels, options), InvalidInput);
}

TEST_CASE("measure_bonds: the smallest of bonds", "[measure_bonds]") {
  auto labels = Int32Grid::create(0);
  labels->tree().setValue(Coord(7, 0, 0), 5);  // across a border of leaves
  labels->tree().setValue(Coord(8, 0, 0), 3);
  const BondMeasures bond = onlyBond(*labels);
  CHECK(bond.first == 3);
  CHECK(bond.second == 5);
  CHECK(bond.faces == 1);
  CHECK(bond.area > 0);
  CHECK(bond.area <= 1.1);
  CHECK(bond.normal == Vec3d(-1, 0, 0));
  CHECK(bond.flatness == 0);
  CHECK(bond.patches == 1);
  CHECK_FALSE(bond.curvature.has_value());
  // Diagonal voxels do not touch.
  labels->tree().setValue(Coord(20, 0, 0), 8);
  labels->tree().setValue(Coord(21, 1, 0), 9);
  CHECK(measure(*labels).bonds.size() == 1);
}
