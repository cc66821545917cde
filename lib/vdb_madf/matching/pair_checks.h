// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/matching/compare.h"
#include "vdb_madf/matching/track.h"

namespace vdb_madf {

// What two label volumes are refused for, and what is to be said of them though it is no error.

/// How messages call the two volumes, and the options that say how far a sample moved.
struct PairNames {
  std::string first, second;
  std::string shift = "shift", maxShift = "max_shift";
};

/// Voxels are compared by their index, so they must be of equal size, where both are known. The
/// labels themselves are not looked at.
/// @throw InvalidInput
void checkSameVoxels(const Int32Grid& first, const Int32Grid& second, const PairNames& names);

/// @throw InvalidInput if no voxel is labeled in both, though there are labels
void checkAnyCommon(const Comparison& comparison, const PairNames& names);
void checkAnyCommon(const Tracks& tracks, const PairNames& names);

/// Says if voxels are labeled in one of the two alone, and if their domains, or the places of
/// voxels of equal index, differ. Of the grids only metadata and transforms are looked at.
std::vector<std::string> notesOn(const Comparison& comparison, const Int32Grid& truth,
                                 const Int32Grid& test);

/// Says if the shift that was found is the largest that is looked for, and if hardly more voxels
/// are common than unrelated samples have by chance: the product of their solid fractions. With a
/// motion: if more of the sample is lost than is followed.
std::vector<std::string> notesOn(const Tracks& tracks, const Int32Grid& before,
                                 const Int32Grid& after, const TrackOptions& options,
                                 const PairNames& names);

}  // namespace vdb_madf
