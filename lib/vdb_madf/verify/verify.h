// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

/// What verify() found.
struct Verification {
  std::string fault;      ///< what the labels are not, as one sentence; empty: they hold
  int64_t differing = 0;  ///< voxels
  int64_t voxels = 0, cavityVoxels = 0, medialBalls = 0, criticalPoints = 0, grains = 0;  ///< right
};

/// Are these the labels that the definition gives for the object, by the options and the domain
/// that the labels' metadata tell, and are the counts right that they tell besides?
///
/// A judge of segment(), segmentSlabs() and remerge(): everything is computed anew, straight from
/// the definition, by code that shares nothing with the method, on dense arrays over the domain's
/// box (where it is unknown, the object's and one layer around). Slabs are read one by one, but it
/// takes about 32 bytes a voxel of that box, and more in noise.
/// @param maxMemory bytes that these arrays may take; 0: no limit
/// @throw InvalidInput if the labels do not say how they were made, were edited or merged by a rule
///   of one's own, or the box is too large; Interrupted.
Verification verify(const LabelSlabs& labels, const MaskGrid& object, int64_t maxMemory = 0,
                    Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
