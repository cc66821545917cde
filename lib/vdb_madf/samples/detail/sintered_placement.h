// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/samples/detail/ball_union.h"
#include "vdb_madf/samples/sintered.h"

namespace vdb_madf::detail {

/// The balls of a sample, sorted by center (x, then y, then z), for options in range.
/// @throw InvalidInput if they cannot be placed; Interrupted.
std::vector<Ball> placeSintered(const SinteredOptions& options, Interrupter* interrupter);

}  // namespace vdb_madf::detail
