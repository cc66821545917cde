// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Where areas and curvatures are least right: bodies placed symmetrically on the lattice, whose
// errors do not average out, bodies with edges, small balls.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "vdb_madf/measure/measure.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

double discArea(const TwoBalls& balls) {
  return measure(*drawDisc(balls)).bonds.at(0).area;
}

/// Two balls along z whose disc lies on a layer of voxels (0) or midway between two (1/2).
TwoBalls alongAxis(double radius, double ball, double place) {
  TwoBalls balls;
  balls.radius = radius;
  balls.first = balls.second = ball;
  balls.normal = {0, 0, 1};
  balls.center = {0, 0, place};
  return balls;
}

/// A rotation, as the directions of three axes.
struct Axes {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  static Axes random(Rng& rng) {
    Axes axes;
    axes.x = randomDirection(rng);
    axes.y = axes.x.cross(randomDirection(rng));
    axes.y.normalize();
    axes.z = axes.x.cross(axes.y);
    return axes;
  }
};

template <typename Inside>
double freeArea(double reach, const Inside& inside) {
  return measure(*drawLabels(cubeAround(reach + 2), inside)).grains.at(0).freeArea;
}

double cubeArea(double edge, const Vec3d& center, const Axes& axes) {
  return freeArea(edge, [&](const Vec3d& p) {
    const Vec3d q = p - center;
    const double half = edge / 2;
    return std::abs(q.dot(axes.x)) < half && std::abs(q.dot(axes.y)) < half &&
           std::abs(q.dot(axes.z)) < half;
  });
}

double cylinderArea(double radius, double height, const Vec3d& center, const Vec3d& axis) {
  return freeArea(radius + height / 2, [&](const Vec3d& p) {
    const Vec3d q = p - center;
    const double along = q.dot(axis);
    return std::abs(along) < height / 2 && q.lengthSqr() - along * along < radius * radius;
  });
}

/// The interface of grain 1 with grain 2 around it.
template <typename Inside>
InterfaceCurvature curvatureOf(int edge, const Inside& inside) {
  const auto labels =
      drawLabels({Coord(-edge), Coord(edge)}, [&](const Vec3d& p) { return inside(p) ? 1 : 2; });
  return measure(*labels).bonds.at(0).curvature.value();
}

}  // namespace

TEST_CASE("hard_bodies: equal balls with whole radii and centers along an axis",
          "[hard_bodies][long]") {
  // All of a disc of radius 8 or more: the distance of the centers is even or odd.
  Errors on, midway;
  for (int radius = 9; radius <= 20; ++radius)
    for (int distance = 1; distance < 2 * radius; ++distance) {
      const double squared = radius * radius - distance * distance / 4.0;
      if (squared < 64) break;
      const TwoBalls balls = alongAxis(std::sqrt(squared), radius, distance % 2 ? 0.5 : 0);
      (distance % 2 ? midway : on).add(discArea(balls), balls.discArea());
    }
  report("symmetric discs, on a layer of voxels", on);
  report("symmetric discs, midway between two", midway);
  for (const Errors* errors : {&on, &midway}) {
    CHECK(errors->mean() < 0.02);
    CHECK(errors->worst() < 0.08);
  }
}

TEST_CASE("hard_bodies: balls around a voxel's center", "[hard_bodies]") {
  Errors errors;
  for (int radius = 8; radius <= 24; ++radius)
    errors.add(freeArea(radius, [&](const Vec3d& p) { return p.lengthSqr() < radius * radius; }),
               4 * M_PI * radius * radius);
  report("balls of radius 8 to 24 around a voxel's center", errors);
  CHECK(errors.mean() < 0.01);
  CHECK(errors.worst() < 0.02);
}

TEST_CASE("hard_bodies: discs of round sizes along an axis", "[hard_bodies][long]") {
  for (const double radius : {8.0, 12.0, 16.0, 24.0}) {
    Errors errors;
    for (int percent = 105; percent <= 200; percent += 5)
      for (const double place : {0.0, 0.5}) {
        const TwoBalls balls = alongAxis(radius, radius * percent / 100, place);
        errors.add(discArea(balls), balls.discArea());
      }
    report("symmetric discs of radius " + std::to_string(int(radius)), errors);
    CHECK(errors.mean() < 0.04);
    CHECK(errors.worst() < 0.1);
  }
}

TEST_CASE("hard_bodies: cubes lose area at their edges", "[hard_bodies]") {
  for (const double edge : {10.0, 20.0}) {
    const double truth = 6 * edge * edge;
    const std::string name = "cube of edge " + std::to_string(int(edge));
    Errors along, turned;
    along.add(cubeArea(edge, Vec3d(0.5), {}), truth);
    Rng rng(uint64_t(7));
    for (int i = 0; i < 24; ++i) {
      const Vec3d center = randomPoint(rng);
      turned.add(cubeArea(edge, center, Axes::random(rng)), truth);
    }
    report(name + ", along the axes", along);
    report(name + ", turned", turned);
    CHECK(along.worst() < 0.8 / edge);
    CHECK(turned.worst() < 0.8 / edge);
  }
}

TEST_CASE("hard_bodies: rounded edges lose little", "[hard_bodies]") {
  Errors errors;
  Rng rng(uint64_t(11));
  for (int i = 0; i < 24; ++i) {
    const double edge = 8 + 8 * rng.unit(), round = 2 + 2 * rng.unit();  // of the flat faces
    const Vec3d center = randomPoint(rng);
    const Axes axes = Axes::random(rng);
    const double area = freeArea(edge + round, [&](const Vec3d& p) {
      const Vec3d q = p - center;
      double squared = 0;
      for (const Vec3d& axis : {axes.x, axes.y, axes.z})
        squared += std::pow(std::max(0.0, std::abs(q.dot(axis)) - edge / 2), 2);
      return squared < round * round;
    });
    errors.add(area, 6 * edge * edge + 6 * M_PI * edge * round + 4 * M_PI * round * round);
  }
  report("cubes with edges rounded by 2 to 4 voxels, turned", errors);
  CHECK(errors.mean() < 0.01);
  CHECK(errors.worst() < 0.02);
}

TEST_CASE("hard_bodies: noise at the surface adds area", "[hard_bodies]") {
  Errors errors;
  Rng rng(uint64_t(12));
  for (int i = 0; i < 12; ++i) {
    const double radius = 12 + 6 * rng.unit();
    const Vec3d center = randomPoint(rng);
    const double area = freeArea(
        radius, [&](const Vec3d& p) { return (p - center).length() < radius + rng.unit() - 0.5; });
    errors.add(area, 4 * M_PI * radius * radius);
  }
  report("balls, each voxel's distance off by up to 1/2", errors);
  CHECK(errors.mean() < 0.15);
}

TEST_CASE("hard_bodies: cylinders lose area at their edges", "[hard_bodies]") {
  for (const double height : {8.0, 24.0}) {
    const double radius = 12, truth = 2 * M_PI * radius * (radius + height);
    const std::string name = "cylinder of radius 12, height " + std::to_string(int(height));
    Errors along, turned;
    Rng rng(uint64_t(8));
    for (int i = 0; i < 24; ++i) {
      const Vec3d center = randomPoint(rng);
      turned.add(cylinderArea(radius, height, center, randomDirection(rng)), truth);
    }
    for (const double place : {0.0, 0.5})
      along.add(cylinderArea(radius, height, Vec3d(place, place, 0.5), {0, 0, 1}), truth);
    report(name + ", along an axis", along);
    report(name + ", turned", turned);
    CHECK(along.worst() < 0.08);
    CHECK(turned.worst() < 0.05);
  }
}

TEST_CASE("hard_bodies: mean curvature of balls and cylinders", "[hard_bodies]") {
  for (const double radius : {6.0, 10.0, 16.0}) {
    Errors balls, cylinders;
    Rng rng(uint64_t(9));
    for (int i = 0; i < 8; ++i) {
      const Vec3d center = i ? randomPoint(rng) : Vec3d(0.0), axis = randomDirection(rng);
      const int edge = int(radius) + 2;
      balls.add(
          curvatureOf(edge,
                      [&](const Vec3d& p) { return (p - center).lengthSqr() < radius * radius; })
              .mean,
          1 / radius);
      cylinders.add(curvatureOf(edge,
                                [&](const Vec3d& p) {
                                  const Vec3d q = p - center;
                                  return q.lengthSqr() - std::pow(q.dot(axis), 2) < radius * radius;
                                })
                        .mean,
                    0.5 / radius);
    }
    report("mean curvature, balls of radius " + std::to_string(int(radius)), balls);
    report("mean curvature, cylinders of radius " + std::to_string(int(radius)), cylinders);
    CHECK(balls.mean() < 0.03);
    CHECK(balls.worst() < 0.05);
    CHECK(cylinders.mean() < 0.08);
  }
}

namespace {

/// The waist of a neck with a round fillet: a ring of the inside of a torus.
struct RoundedNeck {
  double waist, fillet, half;  ///< radii; half the height of the ring
  Vec3d center, axis;

  double radiusAt(double sine) const {
    return waist + fillet - fillet * std::sqrt(1 - sine * sine);
  }
  int32_t operator()(const Vec3d& p) const {
    const Vec3d q = p - center;
    const double along = q.dot(axis);
    if (std::abs(along) > half) return 0;
    const double across = std::sqrt(q.lengthSqr() - along * along);
    return across < radiusAt(along / fillet) ? 1 : 2;
  }
  /// Over the ring, by area.
  std::pair<double, double> meanAndGaussian() const {
    constexpr int kSteps = 1000;
    const double last = std::asin(half / fillet);
    double area = 0, mean = 0, gaussian = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = (i + 0.5) * last / kSteps, radius = radiusAt(std::sin(angle));
      const double around = std::cos(angle) / radius;
      area += radius;
      mean += radius * (around - 1 / fillet) / 2;
      gaussian -= radius * around / fillet;
    }
    return {mean / area, gaussian / area};
  }
};

}  // namespace

TEST_CASE("hard_bodies: curvatures of necks", "[hard_bodies]") {
  Errors errors;
  Rng rng(uint64_t(10));
  for (const auto& [waist, fillet] :
       {std::pair<double, double>(6, 12), {8, 8}, {8, 16}, {12, 8}, {12, 20}}) {
    CAPTURE(waist, fillet);
    const Vec3d center = randomPoint(rng), axis = randomDirection(rng);
    const RoundedNeck neck{waist, fillet, 5, center, axis};
    const auto labels = drawLabels(cubeAround(waist + 8), neck);
    const InterfaceCurvature found = measure(*labels).bonds.at(0).curvature.value();
    const auto [mean, gaussian] = neck.meanAndGaussian();
    CHECK(found.mean == Approx(mean).margin(0.01));
    errors.add(found.gaussian, gaussian);
  }
  report("Gaussian curvature, necks", errors);
  CHECK(errors.mean() < 0.2);
}
