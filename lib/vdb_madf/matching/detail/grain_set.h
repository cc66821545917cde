// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <map>
#include <set>
#include <utility>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf::detail {

/// The grains of labels, from exact sums; lengths are in voxels, which are boxes. Contacts are of
/// a face or more. @throw Interrupted
GrainSet grainSet(const Int32Grid& labels, Interrupter* interrupter);

/// Chooses from pairs of labels, the smaller one first, those of which two voxels lie at most `gap`
/// apart, from center to center. @throw Interrupted
std::set<std::pair<int32_t, int32_t>> nearPairs(const Int32Grid& labels,
                                                const std::set<std::pair<int32_t, int32_t>>& pairs,
                                                int gap, Interrupter* interrupter);

/// Chooses from pairs of labels before those between which there is something solid after, at most
/// of the places of their faces when these are moved. @throw Interrupted
std::set<std::pair<int32_t, int32_t>> solidPairs(const Int32Grid& before, const Int32Grid& after,
                                                 const std::set<std::pair<int32_t, int32_t>>& pairs,
                                                 const std::map<int32_t, Motion>& motions,
                                                 Interrupter* interrupter);

/// How many voxels of each grain before lie in each one after when they are moved, those of a grain
/// of before by its motion; those without one stay out. @throw Interrupted
std::map<std::pair<int32_t, int32_t>, int64_t> movedOverlaps(
    const Int32Grid& before, const Int32Grid& after, const std::map<int32_t, Motion>& motions,
    Interrupter* interrupter);

}  // namespace vdb_madf::detail
