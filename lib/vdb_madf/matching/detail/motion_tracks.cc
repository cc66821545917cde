// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/motion_tracks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/matching/detail/grain_set.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/point_cells.h"
#include "vdb_madf/matching/detail/track_sides.h"
#include "vdb_madf/method/boundary.h"

namespace vdb_madf::detail {

namespace {

/// Whether a ball as large as a grain lies in a domain; of a region 26 points of the ball do.
bool isWithin(const Domain& domain, const openvdb::Vec3d& center, double volume) {
  constexpr double kBall = 0.2387324146378430;  // 3 / (4 pi)
  const double radius = std::cbrt(kBall * volume);
  const CoordBBox& box = domain.box();
  for (int axis = 0; axis < 3; ++axis)
    if (!(center[axis] - radius >= box.min()[axis] - 0.5 &&
          center[axis] + radius <= box.max()[axis] + 0.5))
      return false;
  if (domain.isBox()) return true;
  for (int n = 0; n < 27; ++n) {
    openvdb::Vec3d step(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    step.normalize();  // the middle stays zero
    if (!domain.isInside(Coord::round(center + radius * step))) return false;
  }
  return true;
}

/// Where the center of a grain went: to that of its partner, or, if a scan ends within either, to
/// where its neighbors say.
openvdb::Vec3d placeOf(const FollowedGrain& match, const openvdb::Vec3d& partner) {
  return match.isCut ? match.place : partner;
}

/// Links grains that were followed, and judges all. Of those that were not it is asked whether both
/// volumes show them.
void link(Sides& sides, Tracks& tracks, const GrainSet& before, const GrainSet& after,
          const FollowedGrains& followed, const Domain& domainBefore, const Domain& domainAfter) {
  std::map<int32_t, const GrainFeatures*> ofAfter;
  for (const GrainFeatures& grain : after.grains) ofAfter[grain.grain] = &grain;
  std::vector<openvdb::Vec3d> places;  // after, of those whose gradient is known
  std::vector<size_t> known;
  for (size_t n = 0; n < before.grains.size(); ++n) {
    const GrainFeatures& grain = before.grains[n];
    const FollowedGrain& match = followed.grains[n];
    GrainMove& move = tracks.moves.emplace_back();
    TrackedGrain& here = sides.before.at(grain.grain);
    here.partner = match.partner;
    move.center = grain.center;
    move.isPlaced = match.isPlaced;
    if (!match.partner) {
      if (match.isPlaced) {
        move.displacement = match.place - grain.center;
        move.gradient = match.nearby;
      }
      const bool isSeen = !match.isPlaced || isWithin(domainAfter, match.place, grain.volume);
      here.fate = isSeen ? GrainFate::lost : GrainFate::outside;
      continue;
    }
    const openvdb::Vec3d there = placeOf(match, ofAfter.at(match.partner)->center);
    move.isCut = match.isCut;
    move.confidence = match.confidence;
    move.displacement = there - grain.center;
    move.miss = match.miss;
    move.neighbors = match.neighbors;
    move.gradient = match.gradient;
    TrackedGrain& partner = sides.after.at(match.partner);
    partner.partner = grain.grain;
    here.fate = partner.fate = GrainFate::kept;
    here.links = partner.links = 1;
    sides.link(grain.grain, match.partner);
    tracks.overlaps.push_back({grain.grain, match.partner, here.voxels, true});
    if (!match.gradient || !inverseOf(*match.gradient)) continue;
    places.push_back(there);
    known.push_back(n);
  }
  const PointCells cells(places);
  for (const GrainFeatures& grain : after.grains) {
    TrackedGrain& here = sides.after.at(grain.grain);
    if (here.partner) continue;
    here.fate = GrainFate::appeared;
    if (known.empty()) continue;
    const size_t near = cells.nearest(grain.center, 1)[0];
    const openvdb::Vec3d from =
        before.grains[known[near]].center +
        *inverseOf(*followed.grains[known[near]].gradient) * (grain.center - cells[near]);
    if (!isWithin(domainBefore, from, grain.volume)) here.fate = GrainFate::outside;
  }
}

/// How each grain moved: as its neighbors, about its own center, if it was followed.
Motions motionsOf(const GrainSet& before, const GrainSet& after, const FollowedGrains& followed) {
  std::map<int32_t, openvdb::Vec3d> centers;
  for (const GrainFeatures& grain : after.grains) centers[grain.grain] = grain.center;
  Motions motions;
  for (size_t n = 0; n < before.grains.size(); ++n) {
    const FollowedGrain& match = followed.grains[n];
    const openvdb::Vec3d place =
        match.partner ? placeOf(match, centers.at(match.partner)) : match.place;
    if (match.isPlaced)
      motions[before.grains[n].grain] = {match.nearby,
                                         place - match.nearby * before.grains[n].center};
  }
  return motions;
}

/// Says which grains came apart: `parts` of the other side that were not followed. Most voxels of
/// each lie in the whole when they are moved (`overlaps`: of whole and part), and the volumes
/// agree; of a whole that was followed, better than without the parts.
/// @return the new links, from whole to part
std::vector<GrainOverlap> linkParts(TrackedGrains& wholes, TrackedGrains& parts,
                                    const std::map<LabelPair, int64_t>& overlaps, GrainFate fate) {
  constexpr double kLeastPart = 0.1, kLeast = 0.6, kMost = 1.6;  // of the whole
  const auto isFree = [](const TrackedGrain& grain) {
    return grain.fate == GrainFate::lost || grain.fate == GrainFate::appeared;
  };
  std::map<int32_t, std::pair<int64_t, int32_t>> owners;  // of parts: voxels, and the whole
  for (const auto& [pair, voxels] : overlaps) {
    const TrackedGrain &whole = wholes.at(pair.first), &part = parts.at(pair.second);
    if (!isFree(part) || !(isFree(whole) || whole.fate == GrainFate::kept) ||
        double(part.voxels) < kLeastPart * double(whole.voxels) || 2 * voxels < part.voxels)
      continue;
    auto& owner = owners[pair.second];
    if (voxels > owner.first) owner = {voxels, pair.first};
  }
  std::map<int32_t, std::vector<int32_t>> ofWhole;
  for (const auto& [part, owner] : owners) ofWhole[owner.second].push_back(part);
  std::vector<GrainOverlap> links;
  for (const auto& [number, some] : ofWhole) {
    TrackedGrain& whole = wholes.at(number);
    const double volume = double(whole.voxels);
    const double without = whole.partner ? double(parts.at(whole.partner).voxels) / volume : 0;
    double with = without;
    for (const int32_t part : some) with += double(parts.at(part).voxels) / volume;
    if (whole.partner ? !(std::abs(std::log(with)) < std::abs(std::log(without)))
                      : !(some.size() > 1 && with >= kLeast && with <= kMost))
      continue;
    whole.fate = fate;
    whole.links += int64_t(some.size());
    if (whole.partner) parts.at(whole.partner).fate = fate;
    for (const int32_t part : some) {
      TrackedGrain& here = parts.at(part);
      here.fate = fate;
      here.links = 1;
      here.partner = number;
      links.push_back({number, part, owners.at(part).first, true});
    }
    if (whole.partner) continue;
    int64_t most = 0;
    for (const int32_t part : some)
      if (owners.at(part).first > most) {
        most = owners.at(part).first;
        whole.partner = part;
      }
  }
  return links;
}

/// Links grains that split or merged.
void linkParts(Sides& sides, Tracks& tracks, ScanLabels& before, ScanLabels& after,
               const Motions& motions, Interrupter* interrupter) {
  const auto overlaps = movedOverlaps(before, after, motions, interrupter);
  std::map<LabelPair, int64_t> mirrored;
  for (const auto& [pair, voxels] : overlaps) mirrored[{pair.second, pair.first}] = voxels;
  const auto add = [&](int32_t first, int32_t second, int64_t voxels) {
    sides.link(first, second);
    tracks.overlaps.push_back({first, second, voxels, true});
  };
  for (const GrainOverlap& link : linkParts(sides.before, sides.after, overlaps, GrainFate::split))
    add(link.before, link.after, link.voxels);
  for (const GrainOverlap& link : linkParts(sides.after, sides.before, mirrored, GrainFate::merged))
    add(link.after, link.before, link.voxels);
}

/// Judges grains that were found nowhere and that their own scan cuts: what is seen of such a one
/// does not tell where it would be looked for, nor how large it is.
void leaveOutCut(const GrainSet& set, GrainFate unfound, TrackedGrains& grains) {
  for (const GrainFeatures& grain : set.grains) {
    TrackedGrain& here = grains.at(grain.grain);
    if (grain.isCut && here.fate == unfound) here.fate = GrainFate::outside;
  }
}

/// The ways back of grains after, of those that are linked.
Motions motionsBack(const Links& fromAfter, const Motions& motions) {
  Motions back;
  for (const auto& [grain, links] : fromAfter)
    for (const int32_t linked : links) {
      const auto motion = motions.find(linked);
      const auto inverse =
          motion == motions.end() ? std::nullopt : inverseOf(motion->second.linear);
      if (inverse) back.emplace(grain, Motion{*inverse, -(*inverse * motion->second.shift)});
    }
  return back;
}

/// The bonds of one side, and what tells about them.
struct BondSide {
  std::vector<TrackedBond>& bonds;
  const TrackedGrains& grains;
  const Links& links;
  ScanLabels &here, &there;
  const Motions& motions;
  BondFate open;  ///< bonded here alone

  std::vector<LabelPair> pairsThere(const TrackedBond& bond) const {
    std::vector<LabelPair> pairs;
    for (const int32_t a : links.at(bond.first))
      for (const int32_t b : links.at(bond.second)) pairs.push_back(std::minmax(a, b));
    return pairs;
  }
};

/// Says of bonds that are there on one side alone whether this is sure, and of broken ones whether
/// their grains are near; and that bonds of which an end is outside are so, too.
void settleBonds(const BondSide& side, const TrackOptions& options, Interrupter* interrupter) {
  std::set<LabelPair> open, apart;
  for (const TrackedBond& bond : side.bonds) {
    if (bond.fate != side.open || bond.faces < options.sureFaces) continue;
    open.emplace(bond.first, bond.second);
    for (const LabelPair& pair : side.pairsThere(bond)) apart.insert(pair);
  }
  const std::set<LabelPair> touching = nearPairs(side.there, apart, 1, interrupter),
                            solid =
                                solidPairs(side.here, side.there, open, side.motions, interrupter);
  std::set<LabelPair> near;
  if (side.open == BondFate::separated)
    near = nearPairs(side.there, apart, options.gap, interrupter);
  for (TrackedBond& bond : side.bonds) {
    if (bond.fate == side.open) {
      const std::vector<LabelPair> pairs = side.pairsThere(bond);
      const auto any = [&](const std::set<LabelPair>& of) {
        return std::any_of(pairs.begin(), pairs.end(),
                           [&](const LabelPair& pair) { return of.count(pair) > 0; });
      };
      if (bond.faces < options.sureFaces || any(touching) || solid.count({bond.first, bond.second}))
        bond.fate = BondFate::undecided;
      else if (any(near))
        bond.fate = BondFate::detached;
    }
    for (const int32_t end : {bond.first, bond.second})
      if (side.grains.at(end).fate == GrainFate::outside) bond.fate = BondFate::outside;
  }
}

Domain requiredDomain(const AnyLabels& labels) {
  const Int32Grid& about = aboutOf(labels);
  const auto domain = storedDomain(about);
  if (domain) return *domain;
  if (!std::holds_alternative<Int32Grid::ConstPtr>(labels))
    throw InvalidInput("labels in slabs are followed within their domain, which is unknown");
  return boxOf(about);
}

/// What grains are cut at; none where there is no such, or it is not known.
std::optional<Domain> openDomain(const Int32Grid& about) {
  return storedBoundary(about) == Boundary::closed ? std::nullopt : storedDomain(about);
}

TrackedGrains grainsOf(const GrainSet& set) {
  TrackedGrains grains;
  for (const GrainFeatures& known : set.grains) {
    TrackedGrain& grain = grains[known.grain];
    grain.grain = known.grain;
    grain.voxels = int64_t(known.volume);  // a whole number of voxels
  }
  return grains;
}

}  // namespace

Tracks motionTracks(const AnyLabels& before, const AnyLabels& after, const TrackOptions& options,
                    Interrupter* interrupter) {
  for (const AnyLabels* labels : {&before, &after})
    requireCubicVoxels(aboutOf(*labels), "following grains through a motion");
  const Domain domainBefore = requiredDomain(before), domainAfter = requiredDomain(after);
  ScanLabels labelsBefore(before), labelsAfter(after);
  const ScanSums first = scanSums(labelsBefore, openDomain(aboutOf(before)), interrupter),
                 second = scanSums(labelsAfter, openDomain(aboutOf(after)), interrupter);
  const auto followed = matchGrains(first.set, second.set, *options.motion, interrupter);
  if (!followed)
    throw InvalidInput(
        "no motion is found that brings some grain and its neighbors to such of the later scan: "
        "give labels of the same sample, or a guess of its motion");
  Tracks tracks;
  tracks.motion = options.motion->kind;
  tracks.whole = followed->whole;
  Sides sides{grainsOf(first.set), grainsOf(second.set), {}, {}};
  link(sides, tracks, first.set, second.set, *followed, domainBefore, domainAfter);
  const Motions motions = motionsOf(first.set, second.set, *followed);
  linkParts(sides, tracks, labelsBefore, labelsAfter, motions, interrupter);
  leaveOutCut(first.set, GrainFate::lost, sides.before);
  leaveOutCut(second.set, GrainFate::appeared, sides.after);
  tracks.lastTrack =
      numberTracks(sides, std::exchange(tracks.overlaps, {}), lastTrackOf(aboutOf(before)));
  tracks.bondsBefore = bondsOf(first.contacts, first.contacts, options.minFaces);
  tracks.bondsAfter = bondsOf(second.contacts, second.contacts, options.minFaces);
  const std::set<LabelPair> pairsBefore = pairsOf(tracks.bondsBefore),
                            pairsAfter = pairsOf(tracks.bondsAfter);
  judgeBonds(tracks.bondsBefore, sides.fromBefore, pairsAfter, BondFate::separated);
  judgeBonds(tracks.bondsAfter, sides.fromAfter, pairsBefore, BondFate::created);
  settleBonds({tracks.bondsBefore, sides.before, sides.fromBefore, labelsBefore, labelsAfter,
               motions, BondFate::separated},
              options, interrupter);
  settleBonds({tracks.bondsAfter, sides.after, sides.fromAfter, labelsAfter, labelsBefore,
               motionsBack(sides.fromAfter, motions), BondFate::created},
              options, interrupter);
  tracks.before = listed(sides.before);
  tracks.after = listed(sides.after);
  return tracks;
}

}  // namespace vdb_madf::detail
