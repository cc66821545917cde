// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/samples/bed.h"
#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/detail/particle.h"
#include "vdb_madf/samples/sintered.h"
#include "vdb_madf/samples/spheres.h"

namespace vdb_madf::detail {

// The balls or particles of a sample, for options in range. Those of the first three are sorted by
// center (x, then y, then z). Each @throw InvalidInput if they cannot be drawn or placed;
// Interrupted.

std::vector<Ball> placeSpheres(const SphereOptions& options, Interrupter* interrupter);
std::vector<Ball> placeSintered(const SinteredOptions& options, Interrupter* interrupter);
std::vector<Particle> placeParticles(const ParticleOptions& options, Interrupter* interrupter);

/// Two balls of a bed touch at this part of the sum of their radii.
constexpr double kBedContact = 0.97;

/// The balls of a bed in the order of their fall. @throw InvalidInput for more than 20000
std::vector<Ball> dropBalls(const BedOptions& options, Interrupter* interrupter);

}  // namespace vdb_madf::detail
