// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <vector>

#include "vdb_madf/samples/detail/directions.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/particles.h"

namespace vdb_madf::detail {

using Vector = openvdb::Vec3d;

/// A body about its center, which sees all of its surface. Voxel p is inside if value(p) < 1.
struct Particle {
  Vector center{0, 0, 0};
  enum class Form { faces, ellipsoid, rod, bumpy };
  Form form = Form::faces;
  /// The unit normals of the faces over their distances from the center; of an ellipsoid, bumpy or
  /// not, the unit axes over its half axes; of a rod its unit axis over its radius.
  std::vector<Vector> rows;
  /// Half the line segment that is the core of a rod, in its radii.
  double core = 0;
  /// What bumps make of an ellipsoid, by the directions that the rows make of those in space.
  DirectionMap inverseRadius;
  /// Radius of a ball about the center that contains the particle.
  double reach = 0;

  /// The factor by which the particle has to be scaled about its center to reach p.
  double value(const Vector& p) const;
  /// No two points have values that differ by more than this for each voxel of their distance.
  double slope() const;
  /// A box that contains the voxels inside the particle scaled by a factor.
  CoordBBox box(double scale = 1) const;
};

/// A particle at the origin, of the options' shape and aspect, turned at random, with the volume of
/// a ball of this radius.
Particle drawParticle(const ParticleOptions& options, double radius, RandomSequence& random);

}  // namespace vdb_madf::detail
