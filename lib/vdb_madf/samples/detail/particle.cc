// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/particle.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/portable_math.h"
#include "vdb_madf/samples/detail/sand_grain.h"

namespace vdb_madf::detail {

namespace {

constexpr double kUnitBall = 4.0 / 3.0 * M_PI;

/// The half-spaces of a polyhedron: how many, how far, and the half edge of the cube that bounds
/// them.
constexpr int kMinFaces = 8, kMaxFaces = 14;
constexpr double kMinDistance = 0.8, kMaxDistance = 1.2;
constexpr double kHalfCube = 1.6;
/// Points along half an edge of the cube whose share inside a polyhedron gives its volume.
constexpr int kHalfLattice = 24;

/// Three unit vectors at right angles.
struct Frame {
  Vector axes[3];
};

/// Uniform over all rotations: a unit quaternion from the ball of four dimensions.
Frame drawFrame(RandomSequence& random) {
  double a, b, c, d, square;
  do {
    a = random.uniform(-1, 1);
    b = random.uniform(-1, 1);
    c = random.uniform(-1, 1);
    d = random.uniform(-1, 1);
    square = a * a + b * b + c * c + d * d;
  } while (square > 1 || square < 1e-6);
  const double s = 2 / square;
  return {{{1 - s * (c * c + d * d), s * (b * c + a * d), s * (b * d - a * c)},
           {s * (b * c - a * d), 1 - s * (b * b + d * d), s * (c * d + a * b)},
           {s * (b * d + a * c), s * (c * d - a * b), 1 - s * (b * b + c * c)}}};
}

Particle ellipsoid(const Frame& frame, double a, double b, double c) {
  Particle particle;
  particle.form = Particle::Form::ellipsoid;
  particle.rows = {frame.axes[0] / a, frame.axes[1] / b, frame.axes[2] / c};
  particle.reach = std::max({a, b, c});
  return particle;
}

/// A rod of unit radius.
Particle rod(const Frame& frame, double aspect) {
  Particle particle;
  particle.form = Particle::Form::rod;
  particle.rows = {frame.axes[2]};
  particle.core = aspect - 1;
  particle.reach = aspect;
  return particle;
}

/// A prism of unit width between opposite sides.
Particle hexagonalPrism(const Frame& frame, double height) {
  Particle particle;
  const double root = std::sqrt(3.0);
  const Vector across = frame.axes[1] * (root / 2);
  for (const Vector& normal :
       {frame.axes[0], frame.axes[0] * 0.5 + across, frame.axes[0] * 0.5 - across}) {
    particle.rows.push_back(normal * 2.0);
    particle.rows.push_back(normal * -2.0);
  }
  particle.rows.push_back(frame.axes[2] * (2 / height));
  particle.rows.push_back(frame.axes[2] * (-2 / height));
  particle.reach = std::sqrt(1.0 / 3.0 + height * height / 4);
  return particle;
}

Particle polyhedron(RandomSequence& random) {
  Particle particle;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      Vector row(0, 0, 0);
      row[axis] = side / kHalfCube;
      particle.rows.push_back(row);
    }
  const int faces = random.integer(kMinFaces, kMaxFaces);
  for (int i = 0; i < faces; ++i) {
    const Vector normal = drawDirection(random);
    particle.rows.push_back(normal / random.uniform(kMinDistance, kMaxDistance));
  }
  particle.reach = kHalfCube * std::sqrt(3.0);
  return particle;
}

/// The volume of a polyhedron, by a lattice of points in the cube.
double latticeVolume(const Particle& polyhedron) {
  const double step = kHalfCube / kHalfLattice;
  const auto at = [&](int i) { return (i - kHalfLattice + 0.5) * step; };
  int inside = 0;
  for (int x = 0; x < 2 * kHalfLattice; ++x)
    for (int y = 0; y < 2 * kHalfLattice; ++y)
      for (int z = 0; z < 2 * kHalfLattice; ++z)
        inside += polyhedron.value({at(x), at(y), at(z)}) < 1;
  return inside * step * step * step;
}

void scale(Particle& particle, double factor) {
  for (Vector& row : particle.rows) row = row / factor;
  particle.reach *= factor;
}

Particle sand(const Frame& frame, const SandGrain& grain) {
  const auto& [a, b, c] = grain.axes;
  Particle particle = ellipsoid(frame, a, b, c);
  particle.form = Particle::Form::bumpy;
  particle.inverseRadius = grain.inverseRadius;
  particle.reach *= 1 / grain.inverseRadius.least();
  return particle;
}

/// A particle of the volume of the unit ball.
Particle drawUnit(const ParticleOptions& options, RandomSequence& random) {
  const ParticleShape shape = options.shape;
  Particle particle;
  double volume = 0;
  if (shape == ParticleShape::polyhedra) {
    particle = polyhedron(random);
    volume = latticeVolume(particle);
  } else {
    const Frame frame = drawFrame(random);
    if (shape == ParticleShape::balls) return ellipsoid(frame, 1, 1, 1);
    if (isSand(shape)) {
      const SandGrain grain = drawSandGrain(shape, random);
      particle = sand(frame, grain);
      volume =
          grain.axes[0] * grain.axes[1] * grain.axes[2] * grain.inverseRadius.volumeOfInverse();
    } else if (shape == ParticleShape::ellipsoids) {
      const double b = random.uniform(1.2, 1.4), c = random.uniform(1.55, 1.85);
      particle = ellipsoid(frame, 1, b, c);
      volume = kUnitBall * b * c;
    } else if (haveAspect(shape)) {
      const double aspect = random.uniform(options.minAspect, options.maxAspect);
      const bool isRod = shape == ParticleShape::rods;
      particle = isRod ? rod(frame, aspect) : hexagonalPrism(frame, aspect);
      volume = isRod ? kUnitBall + 2 * M_PI * (aspect - 1) : std::sqrt(3.0) / 2 * aspect;
    } else {
      const bool flat = shape == ParticleShape::plates;
      const double height = flat ? random.uniform(0.28, 0.39) : random.uniform(1.7, 2.3);
      particle = hexagonalPrism(frame, height);
      volume = std::sqrt(3.0) / 2 * height;
    }
  }
  scale(particle, cubeRoot(kUnitBall / volume));
  return particle;
}

/// Of a rod whose core ends at -core and core along its axis, for a point `along` the axis and
/// `across` it from the center, all in radii. Beyond the core the value s solves
/// (along - s core)^2 + across^2 = s^2, written so that nothing cancels.
double rodValue(double core, double along, double across) {
  if (along <= across * core) return across;
  const double square = along * along + across * across;
  const double root = std::sqrt(std::max(0.0, square - across * across * core * core));
  return square / (along * core + root);
}

}  // namespace

double Particle::value(const Vector& p) const {
  const Vector v = p - center;
  double result = 0;
  if (form == Form::rod) return rodValue(core, std::abs(rows[0].dot(v)), rows[0].cross(v).length());
  if (form == Form::ellipsoid) {
    for (const Vector& row : rows) result += row.dot(v) * row.dot(v);
    return std::sqrt(result);
  }
  if (form == Form::bumpy) {
    const Vector u(rows[0].dot(v), rows[1].dot(v), rows[2].dot(v));
    const double length = u.length();
    return length == 0 ? 0 : length * inverseRadius.value(u);
  }
  for (const Vector& row : rows) result = std::max(result, row.dot(v));
  return result;
}

double Particle::slope() const {
  double square = 0;
  for (const Vector& row : rows) square = std::max(square, row.dot(row));
  if (form == Form::bumpy) {
    const double radial = inverseRadius.greatest(), along = inverseRadius.slope();
    square *= radial * radial + along * along;
  }
  return std::sqrt(square);
}

CoordBBox Particle::box(double scale) const {
  const double r = reach * scale;
  const auto corner = [&](double sign) {
    return Coord(int(std::floor(center.x() + sign * r)), int(std::floor(center.y() + sign * r)),
                 int(std::floor(center.z() + sign * r)));
  };
  return {corner(-1), corner(1).offsetBy(1)};
}

Particle drawParticle(const ParticleOptions& options, double radius, RandomSequence& random) {
  Particle particle = drawUnit(options, random);
  scale(particle, radius);
  return particle;
}

}  // namespace vdb_madf::detail
