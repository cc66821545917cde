// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/particles.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/samples.h"
#include "vdb_madf/base/detail/portable_math.h"
#include "vdb_madf/samples/detail/placement.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::Particle;
using detail::Vector;

constexpr ParticleShape kParticleShapes[] = {
    ParticleShape::balls,   ParticleShape::ellipsoids, ParticleShape::plates,
    ParticleShape::prisms,  ParticleShape::polyhedra,  ParticleShape::rods,
    ParticleShape::columns, ParticleShape::sandOttawa, ParticleShape::sandHostun};

ParticleOptions smallParticles(ParticleShape shape) {
  ParticleOptions options;
  options.size = {66, 58, 61};
  options.shape = shape;
  options.count = 10;
  options.minRadius = 7;
  options.maxRadius = 11;
  options.seed = 6;
  return options;
}

Particle drawn(ParticleShape shape, double radius, detail::RandomSequence& random) {
  return detail::drawParticle(smallParticles(shape), radius, random);
}

int64_t voxelsInside(const Particle& particle) {
  int64_t count = 0;
  const CoordBBox box = particle.box();
  for (auto p = box.begin(); p; ++p) count += particle.value((*p).asVec3d()) < 1;
  return count;
}

/// Twice the greatest of the radii from the center, and the width between the two nearest faces.
std::pair<double, double> lengthAndThickness(const Particle& particle) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  double longest = 0;
  for (int i = 0; i < 20000; ++i) {
    Vector u(normal(random), normal(random), normal(random));
    u.normalize();
    longest = std::max(longest, 1 / particle.value(particle.center + u));
  }
  return {2 * longest, 2 / particle.slope()};
}

}  // namespace

// Whoever compares methods on these samples relies on a seed giving the same sample for ever.
TEST_CASE("particles: the bits are fixed", "[particles]") {
  const uint64_t expected[] = {0xcf2ed287e6025746u, 0xb1b8ec1428f1bff7u, 0xf1c9a0b437e1fed8u,
                               0x365f857d4ff3f1a2u, 0x29d8cc19c4ab80cbu, 0x47f8abb44854abccu,
                               0x88325dcd34f23e9du, 0xaa39cb897ffa4c98u, 0xc3fe0163e863783fu};
  for (size_t i = 0; i < std::size(kParticleShapes); ++i) {
    CAPTURE(i);
    CHECK(hash(generateParticles(smallParticles(kParticleShapes[i]))) == expected[i]);
  }
  auto options = smallParticles(ParticleShape::balls);
  options.lognormal = 0.3;
  CHECK(hash(generateParticles(options)) == 0x4fb32d25bd351ac4u);
}

TEST_CASE("particles: seeds differ, threads do not matter", "[particles]") {
  for (const ParticleShape shape : kParticleShapes) {
    auto options = smallParticles(shape);
    requireSeedsDiffer([&](uint64_t seed) {
      options.seed = seed;
      return generateParticles(options);
    });
    options.size = {140, 60, 135};  // several blocks
    requireSameForAnyThreads([&] { return generateParticles(options); });
  }
}

TEST_CASE("particles: have the volume that they are asked for", "[particles]") {
  detail::RandomSequence random(3, 0);
  for (const ParticleShape shape : kParticleShapes)
    for (int i = 0; i < 4; ++i) {
      CAPTURE(int(shape), i);
      const double radius = 9 + i;
      Particle particle = drawn(shape, radius, random);
      particle.center = {20.3, 21.1, 19.8};
      const double volume = 4.0 / 3.0 * M_PI * radius * radius * radius;
      CHECK(double(voxelsInside(particle)) == Approx(volume).epsilon(0.025));
    }
}

TEST_CASE("particles: have the proportions of their shape", "[particles]") {
  detail::RandomSequence random(4, 0);
  const auto proportion = [&](ParticleShape shape) {
    const auto [length, thickness] = lengthAndThickness(drawn(shape, 10, random));
    return length / thickness;
  };
  for (int i = 0; i < 5; ++i) {
    CHECK(proportion(ParticleShape::balls) == Approx(1));
    CHECK(proportion(ParticleShape::ellipsoids) == Approx(1.7).epsilon(0.1));
    // The diagonal of a hexagonal prism: width 1, corners at 2 / sqrt(3), height a third.
    CHECK(proportion(ParticleShape::plates) == Approx(3.6).epsilon(0.2));
    CHECK(proportion(ParticleShape::prisms) == Approx(2.3).epsilon(0.2));
    CHECK(proportion(ParticleShape::polyhedra) < 3.5);
  }
}

TEST_CASE("particles: rods and columns are as long as asked for", "[particles]") {
  detail::RandomSequence random(7, 0);
  for (const double aspect : {1.0, 1.5, 2.0, 5.0, 15.0}) {
    CAPTURE(aspect);
    auto options = smallParticles(ParticleShape::rods);
    options.minAspect = options.maxAspect = aspect;
    const Particle rod = detail::drawParticle(options, 10, random);
    const Vector axis = rod.rows[0].unit();
    const double radius = 1 / rod.rows[0].length();
    CHECK(1 / rod.value(axis) == Approx(aspect * radius));
    const Vector across = axis.cross(Vector(0.3, -0.5, 0.8)).unit();
    const auto isOnSurface = [&](const Vector& p) {
      CHECK(rod.value(p) == Approx(1));
      CHECK(rod.value(p * -2.7) == Approx(2.7));
    };
    const Vector core = axis * ((aspect - 1) * radius);
    for (const double along : {0.0, 0.4, 1.0}) isOnSurface(core * along + across * radius);
    for (const double angle : {0.0, 0.3, 1.2})
      isOnSurface(core + (axis * std::cos(angle) + across * std::sin(angle)) * radius);
    CHECK(rod.value(rod.center) == 0);
    options.shape = ParticleShape::columns;
    const Particle column = detail::drawParticle(options, 10, random);
    const Vector length = column.rows.back(), width = column.rows.front();
    CHECK(width.length() / length.length() == Approx(aspect));
  }
}

TEST_CASE("particles: nothing of a particle lies beyond its reach", "[particles]") {
  detail::RandomSequence random(5, 0);
  std::mt19937 directions(1);
  std::normal_distribution<double> normal;
  for (const ParticleShape shape : kParticleShapes) {
    const Particle particle = drawn(shape, 10, random);
    const double shortest = 1 / particle.slope();
    for (int i = 0; i < 1000; ++i) {
      Vector u(normal(directions), normal(directions), normal(directions));
      u.normalize();
      CHECK(particle.value(u * (particle.reach * (1 + 1e-9))) >= 1);
      CHECK(particle.value(u * (shortest * (1 - 1e-9))) < 1);
    }
  }
}

TEST_CASE("particles: orientations have no preferred direction", "[particles]") {
  detail::RandomSequence random(6, 0);
  constexpr int kCount = 3000;
  Vector squares(0, 0, 0);
  for (int i = 0; i < kCount; ++i) {
    const Particle plate = drawn(ParticleShape::plates, 1, random);
    Vector axis = plate.rows.back();
    axis.normalize();
    squares += axis * axis;
    CHECK(plate.rows[0].unit().dot(axis) == Approx(0).margin(1e-12));
  }
  for (int axis = 0; axis < 3; ++axis)
    CHECK(squares[axis] / kCount == Approx(1.0 / 3).margin(0.02));
}

TEST_CASE("particles: the object is their union, the truth the one of least value", "[particles]") {
  for (const ParticleShape shape : kParticleShapes) {
    CAPTURE(int(shape));
    auto options = smallParticles(shape);
    options.size = {140, 50, 40};  // two blocks
    const auto particles = detail::placeParticles(options, nullptr);
    REQUIRE(int(particles.size()) == options.count);
    const Sample sample = generateParticles(options);
    requireInsideDomain(sample);
    CHECK(sample.truth->tree().hasSameTopology(sample.object->tree()));
    CHECK(int(labelsOf(*sample.truth).size()) == options.count);
    size_t wrong = 0;
    for (auto p = CoordBBox(Coord(0), options.size.offsetBy(-1)).begin(); p; ++p) {
      size_t best = 0;
      for (size_t i = 1; i < particles.size(); ++i)
        if (particles[i].value((*p).asVec3d()) < particles[best].value((*p).asVec3d())) best = i;
      const int32_t label = particles[best].value((*p).asVec3d()) < 1 ? int32_t(best) + 1 : 0;
      wrong += sample.truth->tree().getValue(*p) != label;
      wrong += sample.object->tree().isValueOn(*p) != (label > 0);
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("particles: keep their distance", "[particles]") {
  for (const ParticleShape shape : kParticleShapes) {
    CAPTURE(int(shape));
    auto options = smallParticles(shape);
    options.count = 25;
    options.neck = 0.7;
    const auto particles = detail::placeParticles(options, nullptr);
    for (size_t i = 0; i < particles.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const Vector v = particles[j].center - particles[i].center;
        const double passed = v.length() / particles[i].value(particles[j].center) +
                              v.length() / particles[j].value(particles[i].center);
        CHECK(v.length() >= options.neck * passed * (1 - 1e-12));
      }
    for (auto p = CoordBBox(Coord(0), options.size.offsetBy(-1)).begin(); p; ++p) {
      const auto inCore = std::count_if(particles.begin(), particles.end(), [&](const auto& q) {
        return q.value((*p).asVec3d()) < options.neck;
      });
      if (inCore > 1) FAIL("two shrunken particles share a voxel");
    }
  }
}

TEST_CASE("particles: lognormal radii are spread about the geometric mean", "[particles]") {
  auto options = smallParticles(ParticleShape::balls);
  options.count = 1500;
  options.minRadius = 2;
  options.maxRadius = 50;
  options.lognormal = 0.4;
  options.neck = 0;
  double sum = 0, squares = 0;
  for (const Particle& particle : detail::placeParticles(options, nullptr)) {
    CHECK((particle.reach >= 2 && particle.reach <= 50));
    const double value = std::log(particle.reach);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / options.count;
  CHECK(mean == Approx(std::log(10)).margin(0.04));
  CHECK(std::sqrt(squares / options.count - mean * mean) == Approx(0.4).margin(0.03));
}

TEST_CASE("particles: functions equal the library's", "[particles]") {
  for (double x = -8; x <= 8; x += 0.37) CHECK(detail::exponential(x) == Approx(std::exp(x)));
  for (double x = 1e-3; x < 1e3; x *= 1.7)
    CHECK(detail::cubeRoot(x) == Approx(std::cbrt(x)).epsilon(1e-14));
}

TEST_CASE("particles: says how many fit", "[particles]") {
  auto options = smallParticles(ParticleShape::balls);
  options.count = 500;
  CHECK_THROWS_WITH(generateParticles(options), vdb_madf::test::Contains("of 500 particles fit") &&
                                                    !vdb_madf::test::Contains("\n"));
}

TEST_CASE("particles: one voxel", "[particles]") {
  for (const ParticleShape shape : kParticleShapes) {
    ParticleOptions options;
    options.size = Coord(1);
    options.count = 1;
    options.shape = shape;
    CHECK(generateParticles(options).truth->activeVoxelCount() == 1);
  }
}

TEST_CASE("particles: bad options are refused", "[particles]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuses = [](auto change) {
    ParticleOptions options = smallParticles(ParticleShape::plates);
    change(options);
    CHECK_THROWS_AS(generateParticles(options), InvalidInput);
  };
  refuses([](auto& o) { o.size = {0, 0, 0}; });
  refuses([](auto& o) { o.count = 0; });
  refuses([](auto& o) { o.minRadius = 0; });
  refuses([](auto& o) { o.minRadius = o.maxRadius + 1; });
  refuses([](auto& o) { o.neck = -1; });
  refuses([&](auto& o) { o.neck = nan; });
  refuses([](auto& o) { o.lognormal = -0.1; });
  refuses([](auto& o) { o.lognormal = 1.1; });
  refuses([&](auto& o) { o.lognormal = nan; });
  refuses([](auto& o) { o.minAspect = 0.9; });
  refuses([](auto& o) { o.maxAspect = 101; });
  refuses([](auto& o) { o.minAspect = o.maxAspect + 1; });
  refuses([&](auto& o) { o.maxAspect = nan; });
  refuses([](auto& o) {  // no range for a spread
    o.lognormal = 0.2;
    o.minRadius = o.maxRadius;
  });
}

TEST_CASE("particles: stops when asked to", "[particles]") {
  for (const ParticleShape shape : kParticleShapes)
    requireStops([&](Interrupter* stop) { return generateParticles(smallParticles(shape), stop); });
}
