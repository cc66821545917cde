// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/matching/track.h"

namespace vdb_madf::detail {

using LabelPair = std::pair<int32_t, int32_t>;
/// The grains of one side, by number.
using TrackedGrains = std::map<int32_t, TrackedGrain>;
/// The grains that each grain of one side is linked with.
using Links = std::map<int32_t, std::set<int32_t>>;

/// The two sides, and how they are linked.
struct Sides {
  TrackedGrains before, after;
  Links fromBefore, fromAfter;

  void link(int32_t grainBefore, int32_t grainAfter) {
    fromBefore[grainBefore].insert(grainAfter);
    fromAfter[grainAfter].insert(grainBefore);
  }
};

/// Gives the grains their numbers through time, see track(). @param last that was used before
/// @return the largest number so far. @throw InvalidInput if there are none left
int32_t numberTracks(Sides& sides, std::vector<GrainOverlap> links, int64_t last);
/// What a series of labels has used already.
int64_t lastTrackOf(const Int32Grid& labels);

/// Bonds of one side, whose fate is `outside` or `unmatched`. @param shared contacts in what both
/// volumes show
std::vector<TrackedBond> bondsOf(const std::vector<LabelContact>& contacts,
                                 const std::vector<LabelContact>& shared, int64_t minFaces);
/// The pairs of bonds in what both volumes show.
std::set<LabelPair> pairsOf(const std::vector<TrackedBond>& bonds);
/// Judges the bonds of one side. `lost`: the grains are linked, but have no such bond there.
void judgeBonds(std::vector<TrackedBond>& bonds, const Links& links,
                const std::set<LabelPair>& there, BondFate lost);

std::vector<TrackedGrain> listed(const TrackedGrains& grains);

}  // namespace vdb_madf::detail
