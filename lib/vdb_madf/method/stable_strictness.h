// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/method/hierarchy.h"

namespace vdb_madf {

/// Where a hierarchy is best cut if nothing is known of the sample.
struct StableStrictness {
  /// What a cut at a strictness gives.
  struct Level {
    double strictness = 0;
    int64_t grains = 0;
    /// Mean over the voxels of how far the strictness can go until their grain is another one
    /// (GrainLife::stability), 1 at most.
    double stability = 0;
  };
  std::vector<Level> levels;  ///< 8, 8.1 ... 14
  double strictness = 11;     ///< the level of largest stability; of several the nearest to 11
  /// The widest interval of levels, 1 or more wide, in which the number of grains changes by less
  /// than 5 %; none: the sample has no preferred scale.
  std::optional<std::pair<double, double>> plateau;
};

/// @throw InvalidInput if hierarchy.lowest is above 8.
StableStrictness stableStrictness(const Hierarchy& hierarchy);

}  // namespace vdb_madf
