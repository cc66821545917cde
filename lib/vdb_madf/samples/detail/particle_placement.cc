// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/placement.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_madf/base/detail/portable_math.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Random centers tried for a particle before the box counts as full.
constexpr int kMaxParticleTries = 50000;
constexpr int kParticlePollInterval = 256;
/// Lognormal radii drawn before the range counts as too narrow for them.
constexpr int kMaxRadii = 10000;

/// The scans of a sample have streams of their own.
constexpr uint64_t kParticleStream = 0;

double drawRadius(const ParticleOptions& options, RandomSequence& random) {
  if (options.lognormal == 0) return random.uniform(options.minRadius, options.maxRadius);
  const double middle = std::sqrt(options.minRadius * options.maxRadius);
  for (int i = 0; i < kMaxRadii; ++i) {
    const double radius = middle * exponential(options.lognormal * random.normal());
    if (radius >= options.minRadius && radius <= options.maxRadius) return radius;
  }
  throw InvalidInput(
      "hardly any lognormal radius lies in so narrow a range: use a smaller lognormal, or a wider "
      "radius");
}

bool shareVoxel(const Particle& a, const Particle& b, double scale) {
  CoordBBox box = a.box(scale);
  box.intersect(b.box(scale));
  for (int x = box.min().x(); x <= box.max().x(); ++x)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int z = box.min().z(); z <= box.max().z(); ++z) {
        const Vector p(x, y, z);
        if (a.value(p) < scale && b.value(p) < scale) return true;
      }
  return false;
}

/// Whether two centers are as far apart as the neck asks for, along the line between them: a
/// particle spans the part 1 / value(the other center) of their distance.
bool centersApart(const Particle& a, const Particle& b, double neck) {
  return neck * (1 / a.value(b.center) + 1 / b.value(a.center)) <= 1;
}

bool fits(const Particle& particle, const std::vector<Particle>& others, double neck) {
  if (neck == 0) return true;
  std::vector<const Particle*> near;
  for (const Particle& other : others) {
    const Vector v = other.center - particle.center;
    const double reach = neck * (particle.reach + other.reach);
    if (v.dot(v) >= reach * reach) continue;
    if (!centersApart(particle, other, neck)) return false;
    near.push_back(&other);
  }
  return std::none_of(near.begin(), near.end(),
                      [&](const Particle* other) { return shareVoxel(particle, *other, neck); });
}

}  // namespace

/// Random sequential addition: each particle tries centers until one fits.
std::vector<Particle> placeParticles(const ParticleOptions& options, Interrupter* interrupter) {
  RandomSequence random(options.seed, kParticleStream);
  std::vector<Particle> particles;
  while (int(particles.size()) < options.count) {
    Particle particle = drawParticle(options, drawRadius(options, random), random);
    int tries = 0;
    do {
      if (tries % kParticlePollInterval == 0 && interrupter && interrupter->wasInterrupted())
        throw Interrupted();
      if (tries++ == kMaxParticleTries)
        throw InvalidInput("only " + std::to_string(particles.size()) + " of " +
                           std::to_string(options.count) +
                           " particles fit: use a smaller count, radius or neck, or a larger size");
      for (int axis = 0; axis < 3; ++axis)
        particle.center[axis] = random.uniform(-0.5, options.size[axis] - 0.5);
    } while (!fits(particle, particles, options.neck));
    particles.push_back(std::move(particle));
  }
  std::stable_sort(particles.begin(), particles.end(),
                   [](const Particle& a, const Particle& b) { return a.center < b.center; });
  return particles;
}

}  // namespace vdb_madf::detail
