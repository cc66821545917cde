// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/sand_grain.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/catch.h"
#include "vdb_madf/measure/detail/convex_hull.h"
#include "vdb_madf/samples/detail/particle.h"

namespace {

using namespace vdb_madf;
using detail::DirectionMap;
using detail::Particle;
using detail::Vector;

constexpr int kMeshCells = 20;  // along an edge of the cube whose faces the surface is seen through

/// Sphericity (of a ball of equal volume the area over its own), convexity (volume over that of
/// the hull), flatness and elongation (of the ellipsoid of equal second moments: minor over middle
/// and middle over major axis).
using ShapeNumbers = std::array<double, 4>;

ShapeNumbers shapeNumbers(const Particle& particle) {
  std::vector<Vector> points;
  double area = 0, volume = 0;
  Vector moment(0, 0, 0);
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  const auto addTriangle = [&](const Vector& a, const Vector& b, const Vector& c) {
    area += (b - a).cross(c - a).length() / 2;
    const double part = std::abs(a.dot(b.cross(c))) / 6;  // of the tetrahedron with the center
    volume += part;
    moment += (a + b + c) * (part / 4);
    for (const Vector& v : {a, b, c, a + b + c}) {
      const Eigen::Vector3d p(v[0], v[1], v[2]);
      products += part / 20 * p * p.transpose();
    }
  };
  for (int face = 0; face < 6; ++face) {
    const auto at = [&](int i, int j) {
      Vector v;
      v[face / 2] = face % 2 ? 1 : -1;
      v[(face / 2 + 1) % 3] = std::tan(M_PI / 4 * (2.0 * i / kMeshCells - 1));
      v[(face / 2 + 2) % 3] = std::tan(M_PI / 4 * (2.0 * j / kMeshCells - 1));
      return v / particle.value(v);
    };
    for (int i = 0; i < kMeshCells; ++i)
      for (int j = 0; j < kMeshCells; ++j) {
        const Vector a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
        addTriangle(a, b, c);
        addTriangle(a, c, d);
        points.push_back(a);
      }
  }
  const Eigen::Vector3d mean = Eigen::Vector3d(moment[0], moment[1], moment[2]) / volume;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(products / volume -
                                                               mean * mean.transpose());
  const Eigen::Vector3d axes = moments.eigenvalues().cwiseSqrt();
  return {std::cbrt(36 * M_PI * volume * volume) / area, volume / detail::convexHull(points).volume,
          axes[0] / axes[1], axes[1] / axes[2]};
}

/// Quantiles of 10, 25, 50, 75 and 90 % of the four numbers: Sand Atlas (X-ray tomography).
struct MeasuredSand {
  ParticleShape shape;
  double tolerance;
  double quantiles[4][5];
};
constexpr MeasuredSand kMeasuredSands[] = {{ParticleShape::sandOttawa,
                                            0.03,
                                            {{0.843, 0.863, 0.887, 0.907, 0.927},
                                             {0.901, 0.922, 0.940, 0.955, 0.967},
                                             {0.624, 0.695, 0.776, 0.848, 0.905},
                                             {0.626, 0.692, 0.767, 0.842, 0.898}}},
                                           {ParticleShape::sandOttawaFine,
                                            0.03,
                                            {{0.773, 0.792, 0.818, 0.844, 0.868},
                                             {0.838, 0.860, 0.883, 0.913, 0.928},
                                             {0.599, 0.664, 0.743, 0.832, 0.892},
                                             {0.596, 0.656, 0.746, 0.822, 0.888}}},
                                           {ParticleShape::sandHamburg,
                                            0.03,
                                            {{0.798, 0.838, 0.876, 0.907, 0.930},
                                             {0.843, 0.881, 0.915, 0.941, 0.958},
                                             {0.608, 0.685, 0.772, 0.853, 0.909},
                                             {0.621, 0.696, 0.777, 0.851, 0.907}}},
                                           {ParticleShape::sandHostun,
                                            0.07,  // of 54 grains
                                            {{0.628, 0.694, 0.729, 0.756, 0.786},
                                             {0.712, 0.759, 0.798, 0.830, 0.859},
                                             {0.570, 0.660, 0.716, 0.780, 0.859},
                                             {0.510, 0.647, 0.765, 0.816, 0.869}}}};

Particle sandGrain(ParticleShape shape, detail::RandomSequence& random) {
  ParticleOptions options;
  options.shape = shape;
  return detail::drawParticle(options, 1, random);
}

}  // namespace

TEST_CASE("sand_grain: shapes have the quantiles of real sands", "[sand_grain]") {
  constexpr int kGrains = 500;
  constexpr double kShares[] = {0.1, 0.25, 0.5, 0.75, 0.9};
  for (const MeasuredSand& sand : kMeasuredSands) {
    detail::RandomSequence random(1, 0);
    std::vector<ShapeNumbers> grains;
    for (int i = 0; i < kGrains; ++i) grains.push_back(shapeNumbers(sandGrain(sand.shape, random)));
    for (size_t number = 0; number < 4; ++number) {
      std::vector<double> sorted;
      for (const ShapeNumbers& grain : grains) sorted.push_back(grain[number]);
      std::sort(sorted.begin(), sorted.end());
      for (size_t i = 0; i < 5; ++i) {
        CAPTURE(int(sand.shape), number, kShares[i]);
        CHECK(sorted[size_t(kShares[i] * (kGrains - 1))] ==
              Approx(sand.quantiles[number][i]).epsilon(sand.tolerance));
      }
    }
  }
}

TEST_CASE("sand_grain: a ball without bumps has the numbers of a ball", "[sand_grain]") {
  Particle ball;
  ball.form = Particle::Form::ellipsoid;
  ball.rows = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const double number : shapeNumbers(ball)) CHECK(number == Approx(1).epsilon(0.01));
}

TEST_CASE("sand_grain: values change along a grain as far as they say", "[sand_grain]") {
  std::mt19937 generator(2);
  std::normal_distribution<double> normal;
  detail::RandomSequence random(5, 0);
  for (int i = 0; i < 8; ++i) {
    const Particle grain = sandGrain(kMeasuredSands[i % 4].shape, random);
    double steepest = 0;
    for (int k = 0; k < 20000; ++k) {
      const auto draw = [&] {
        const double x = normal(generator), y = normal(generator), z = normal(generator);
        return Vector(x, y, z);
      };
      const Vector p = draw(), q = p + draw() * 0.05;
      steepest = std::max(steepest, std::abs(grain.value(p) - grain.value(q)) / (p - q).length());
    }
    CHECK(steepest <= grain.slope());
    CHECK(steepest > grain.slope() / 6);
  }
}
