// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/math/Vec3.h>

#include <vector>

#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/particles.h"

namespace vdb_madf::detail {

using Vector = openvdb::Vec3d;

/// A convex body about its center. Voxel p is inside if value(p) < 1.
struct Particle {
  Vector center{0, 0, 0};
  /// The unit axes of an ellipsoid over its half axes; else the unit normals of the faces over
  /// their distances from the center.
  std::vector<Vector> rows;
  bool round = false;
  /// Radius of a ball about the center that contains the particle.
  double reach = 0;

  /// The factor by which the particle has to be scaled about its center to reach p.
  double value(const Vector& p) const;
  /// No two points have values that differ by more than this for each voxel of their distance.
  double slope() const;
  /// A box that contains the voxels inside the particle scaled by a factor.
  CoordBBox box(double scale = 1) const;
};

/// A particle at the origin, turned at random, with the volume of a ball of this radius.
Particle drawParticle(ParticleShape shape, double radius, RandomSequence& random);

}  // namespace vdb_madf::detail
