// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/track_sides.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <limits>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

int64_t lastTrackOf(const Int32Grid& labels) {
  const auto last = labels.getMetadata<openvdb::Int64Metadata>(kLastTrackKey);
  return last ? std::clamp<int64_t>(last->value(), 0, std::numeric_limits<int32_t>::max()) : 0;
}

int32_t numberTracks(Sides& sides, std::vector<GrainOverlap> links, int64_t last) {
  std::stable_sort(links.begin(), links.end(), [](const GrainOverlap& a, const GrainOverlap& b) {
    return a.voxels > b.voxels;
  });
  std::set<int32_t> used;
  for (const GrainOverlap& overlap : links) {
    TrackedGrain& after = sides.after.at(overlap.after);
    if (overlap.isLink && after.track == 0 && used.insert(overlap.before).second)
      after.track = overlap.before;
  }
  for (auto& [own, grain] : sides.before) {
    grain.track = own;
    last = std::max<int64_t>(last, own);
  }
  for (auto& [own, grain] : sides.after) {
    if (grain.track > 0) continue;
    if (++last > std::numeric_limits<int32_t>::max())
      throw InvalidInput("there are no numbers left for new grains: renumber the first labels");
    grain.track = int32_t(last);
  }
  return int32_t(last);
}

std::vector<TrackedBond> bondsOf(const std::vector<LabelContact>& contacts,
                                 const std::vector<LabelContact>& shared, int64_t minFaces) {
  std::map<LabelPair, int64_t> sharedFaces;
  for (const LabelContact& contact : shared)
    sharedFaces[{contact.first, contact.second}] = contact.faces;
  std::vector<TrackedBond> bonds;
  for (const LabelContact& contact : contacts) {
    if (contact.faces < minFaces) continue;
    const auto here = sharedFaces.find({contact.first, contact.second});
    const int64_t faces = here == sharedFaces.end() ? 0 : here->second;
    bonds.push_back(
        {contact.first, contact.second, contact.faces, faces,
         faces < std::max<int64_t>(minFaces, 1) ? BondFate::outside : BondFate::unmatched});
  }
  return bonds;
}

std::set<LabelPair> pairsOf(const std::vector<TrackedBond>& bonds) {
  std::set<LabelPair> pairs;
  for (const TrackedBond& bond : bonds)
    if (bond.fate != BondFate::outside) pairs.emplace(bond.first, bond.second);
  return pairs;
}

void judgeBonds(std::vector<TrackedBond>& bonds, const Links& links,
                const std::set<LabelPair>& there, BondFate lost) {
  for (TrackedBond& bond : bonds) {
    const auto first = links.find(bond.first), second = links.find(bond.second);
    if (bond.fate == BondFate::outside || first == links.end() || second == links.end()) continue;
    bond.fate = lost;
    for (const int32_t a : first->second) {
      if (bond.fate == lost && second->second.count(a)) bond.fate = BondFate::inside;
      for (const int32_t b : second->second)
        if (a != b && there.count({std::min(a, b), std::max(a, b)})) bond.fate = BondFate::kept;
    }
  }
}

std::vector<TrackedGrain> listed(const TrackedGrains& grains) {
  std::vector<TrackedGrain> list;
  for (const auto& [number, grain] : grains) list.push_back(grain);
  return list;
}

}  // namespace vdb_madf::detail
