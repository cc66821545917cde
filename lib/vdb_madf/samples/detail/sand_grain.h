// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "vdb_madf/samples/detail/directions.h"
#include "vdb_madf/samples/detail/random.h"
#include "vdb_madf/samples/particles.h"

namespace vdb_madf::detail {

/// The shape of a grain of sand: an ellipsoid with bumps and dents.
struct SandGrain {
  std::array<double, 3> axes;  ///< the longest first
  /// One over the radius of the ball with the bumps, by the direction.
  DirectionMap inverseRadius;
};

/// @param shape a sand
SandGrain drawSandGrain(ParticleShape shape, RandomSequence& random);

}  // namespace vdb_madf::detail
