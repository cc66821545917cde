// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/samples/bed.h"
#include "vdb_madf/samples/detail/ball_union.h"

namespace vdb_madf::detail {

/// Two balls of a bed touch at this part of the sum of their radii.
constexpr double kBedContact = 0.97;

/// The balls of a bed in the order of their fall, for options in range. @throw InvalidInput
/// for more than 20000; Interrupted
std::vector<Ball> dropBalls(const BedOptions& options, Interrupter* interrupter);

}  // namespace vdb_madf::detail
