// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/samples/detail/particle.h"

namespace vdb_madf::detail {

/// The particles of a sample, sorted by center (x, then y, then z), for options in range.
/// @throw InvalidInput if they cannot be drawn or placed; Interrupted.
std::vector<Particle> placeParticles(const ParticleOptions& options, Interrupter* interrupter);

}  // namespace vdb_madf::detail
