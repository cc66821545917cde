// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/matching/track.h"

namespace vdb_madf::tools {

// The tables of the verb track, as CSV.

/// Grains of either side: with a motion their moves, else what they overlap.
std::string trackedGrainTable(const Tracks& tracks);
/// Pairs of grains that have voxels in common.
std::string trackLinkTable(const Tracks& tracks);
/// Bonds of either side.
std::string trackedBondTable(const Tracks& tracks);

}  // namespace vdb_madf::tools
