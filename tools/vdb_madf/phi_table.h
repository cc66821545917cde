// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/matching/track.h"

namespace vdb_madf::tools {

/// The motion of grains as a field of Phi, tab-separated, as spam's discrete volume correlation
/// takes it for a first guess (spam.helpers.tsvio): a row for each number from 0 to the largest
/// label before, with center, rotation and displacement in voxels of images whose first voxels are
/// these, z before y before x. `returnStatus` is 2 of grains that were followed, 1 of those
/// whose neighbors say where they should be, and -1 of all other numbers, which stay where they
/// are.
/// @pre tracked with a motion
std::string phiTable(const Tracks& tracks, const Coord& firstBefore, const Coord& firstAfter);

}  // namespace vdb_madf::tools
