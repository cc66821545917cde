// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/track.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/labels/detail/relabelled.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/matching/compare.h"
#include "vdb_madf/matching/detail/grain_set.h"
#include "vdb_madf/matching/detail/local_fit.h"
#include "vdb_madf/matching/detail/moved_labels.h"
#include "vdb_madf/matching/detail/point_cells.h"
#include "vdb_madf/matching/detail/rigid_shift.h"
#include "vdb_madf/segmentation/graph_metadata.h"

namespace vdb_madf {

namespace {

/// The grains of one side, by number.
using TrackedGrains = std::map<int32_t, TrackedGrain>;
/// The grains that each grain of one side is linked with.
using Links = std::map<int32_t, std::set<int32_t>>;

void check(const TrackOptions& options) {
  if (options.maxShift < 0 || options.maxShift > kMaxShift)
    throw InvalidInput("the largest shift must lie between 0 and " + std::to_string(kMaxShift) +
                       " voxels");
  if (!(options.share > 0 && options.share <= 1))
    throw InvalidInput("the share of voxels that links grains must lie above 0, and be 1 at most");
  if (options.minFaces < 0) throw InvalidInput("the fewest faces of a bond must be 0 or more");
  if (options.sureFaces < 0)
    throw InvalidInput("the faces of a bond that breaks for sure must be 0 or more");
  if (options.gap < 1 || options.gap > kMaxGap)
    throw InvalidInput("the gap of a detached bond must lie between 1 and " +
                       std::to_string(kMaxGap) + " voxels");
  if (options.shift)
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(int64_t((*options.shift)[axis])) > kMaxExtent)
        throw InvalidInput("a shift is at most " + std::to_string(kMaxExtent) + " voxels");
}

/// The box of a domain that has moved; all there is, if it is unknown.
CoordBBox shownBox(const Int32Grid& labels, const Coord& shift) {
  const auto domain = storedDomain(labels);
  if (!domain) return CoordBBox::inf();
  return {domain->box().min() + shift, domain->box().max() + shift};
}

TrackedGrains grainsOf(const Int32Grid& labels, Interrupter* interrupter) {
  TrackedGrains grains;
  for (const auto& [number, voxels] : labelSizes(labels, interrupter)) {
    TrackedGrain& grain = grains[number];
    grain.grain = number;
    grain.voxels = voxels;
  }
  return grains;
}

/// Counts an overlap with a grain of the other side; 0: with none. They come in ascending order.
void addOverlap(TrackedGrains& grains, int32_t number, int32_t other, int64_t voxels) {
  if (!number) return;
  TrackedGrain& grain = grains.at(number);
  grain.sharedVoxels += voxels;
  if (!other || voxels <= grain.overlapVoxels) return;
  grain.partner = other;
  grain.overlapVoxels = voxels;
}

/// The two sides, and how they are linked.
struct Sides {
  TrackedGrains before, after;
  Links fromBefore, fromAfter;
};

void link(Sides& sides, std::vector<GrainOverlap>& overlaps, double share) {
  for (GrainOverlap& overlap : overlaps) {
    const int64_t smaller = std::min(sides.before.at(overlap.before).sharedVoxels,
                                     sides.after.at(overlap.after).sharedVoxels);
    overlap.isLink = double(overlap.voxels) >= share * double(smaller);
    if (!overlap.isLink) continue;
    sides.fromBefore[overlap.before].insert(overlap.after);
    sides.fromAfter[overlap.after].insert(overlap.before);
  }
}

/// What is said of the grains of one side. `several`: one that is linked with several; `part`: one
/// that is linked with a grain that is linked with several.
void judge(TrackedGrains& grains, const Links& own, const Links& other, GrainFate several,
           GrainFate part, GrainFate none) {
  for (auto& [number, grain] : grains) {
    const auto links = own.find(number);
    grain.links = links == own.end() ? 0 : int64_t(links->second.size());
    if (grain.sharedVoxels == 0)
      grain.fate = GrainFate::outside;
    else if (grain.links == 0)
      grain.fate = none;
    else if (grain.links > 1)
      grain.fate = several;
    else
      grain.fate = other.at(*links->second.begin()).size() > 1 ? part : GrainFate::kept;
  }
}

/// What a series of labels has used already.
int64_t lastTrackOf(const Int32Grid& labels) {
  const auto last = labels.getMetadata<openvdb::Int64Metadata>(kLastTrackKey);
  return last ? std::clamp<int64_t>(last->value(), 0, std::numeric_limits<int32_t>::max()) : 0;
}

/// Returns the largest number so far.
int32_t number(Sides& sides, std::vector<GrainOverlap> links, int64_t last) {
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

using Pair = std::pair<int32_t, int32_t>;

/// Judges the bonds of one side. `lost`: the grains are linked, but have no such bond there.
void judge(std::vector<TrackedBond>& bonds, const Links& links, const std::set<Pair>& there,
           BondFate lost) {
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

/// \p shared: the same labels, as far as both volumes show them.
std::vector<TrackedBond> bondsOf(const Int32Grid& labels, const Int32Grid& shared, int64_t minFaces,
                                 Interrupter* interrupter) {
  std::map<Pair, int64_t> sharedFaces;
  for (const detail::LabelContact& contact : detail::labelContacts(shared, interrupter))
    sharedFaces[{contact.first, contact.second}] = contact.faces;
  std::vector<TrackedBond> bonds;
  for (const detail::LabelContact& contact : detail::labelContacts(labels, interrupter)) {
    if (contact.faces < minFaces) continue;
    const auto here = sharedFaces.find({contact.first, contact.second});
    const int64_t faces = here == sharedFaces.end() ? 0 : here->second;
    bonds.push_back(
        {contact.first, contact.second, contact.faces, faces,
         faces < std::max<int64_t>(minFaces, 1) ? BondFate::outside : BondFate::unmatched});
  }
  return bonds;
}

/// The pairs of bonds in what both volumes show.
std::set<Pair> pairsOf(const std::vector<TrackedBond>& bonds) {
  std::set<Pair> pairs;
  for (const TrackedBond& bond : bonds)
    if (bond.fate != BondFate::outside) pairs.emplace(bond.first, bond.second);
  return pairs;
}

/// Whether a ball as large as a grain lies in a box.
bool isWithin(const CoordBBox& box, const openvdb::Vec3d& center, double volume) {
  constexpr double kBall = 0.2387324146378430;  // 3 / (4 pi)
  const double radius = std::cbrt(kBall * volume);
  for (int axis = 0; axis < 3; ++axis)
    if (!(center[axis] - radius >= box.min()[axis] - 0.5 &&
          center[axis] + radius <= box.max()[axis] + 0.5))
      return false;
  return true;
}

/// Links grains that were followed, and judges all. Of those that were not it is asked whether both
/// volumes show them.
void link(Sides& sides, Tracks& tracks, const GrainSet& before, const GrainSet& after,
          const FollowedGrains& followed, const CoordBBox& boxBefore, const CoordBBox& boxAfter) {
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
      const bool isSeen = !match.isPlaced || isWithin(boxAfter, match.place, grain.volume);
      here.fate = isSeen ? GrainFate::lost : GrainFate::outside;
      continue;
    }
    const openvdb::Vec3d& there = ofAfter.at(match.partner)->center;
    move.confidence = match.confidence;
    move.displacement = there - grain.center;
    move.miss = match.miss;
    move.neighbors = match.neighbors;
    move.gradient = match.gradient;
    TrackedGrain& partner = sides.after.at(match.partner);
    partner.partner = grain.grain;
    here.fate = partner.fate = GrainFate::kept;
    here.links = partner.links = 1;
    sides.fromBefore[grain.grain].insert(match.partner);
    sides.fromAfter[match.partner].insert(grain.grain);
    tracks.overlaps.push_back({grain.grain, match.partner, here.voxels, true});
    if (!match.gradient || !detail::inverseOf(*match.gradient)) continue;
    places.push_back(there);
    known.push_back(n);
  }
  const detail::PointCells cells(places);
  for (const GrainFeatures& grain : after.grains) {
    TrackedGrain& here = sides.after.at(grain.grain);
    if (here.partner) continue;
    here.fate = GrainFate::appeared;
    if (known.empty()) continue;
    const size_t near = cells.nearest(grain.center, 1)[0];
    const openvdb::Vec3d from =
        before.grains[known[near]].center +
        *detail::inverseOf(*followed.grains[known[near]].gradient) * (grain.center - cells[near]);
    if (!isWithin(boxBefore, from, grain.volume)) here.fate = GrainFate::outside;
  }
}

/// How each grain moved: as its neighbors, about its own center, if it was followed.
std::map<int32_t, Motion> motionsOf(const GrainSet& before, const GrainSet& after,
                                    const FollowedGrains& followed) {
  std::map<int32_t, openvdb::Vec3d> centers;
  for (const GrainFeatures& grain : after.grains) centers[grain.grain] = grain.center;
  std::map<int32_t, Motion> motions;
  for (size_t n = 0; n < before.grains.size(); ++n) {
    const FollowedGrain& match = followed.grains[n];
    const openvdb::Vec3d place = match.partner ? centers.at(match.partner) : match.place;
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
                                    const std::map<Pair, int64_t>& overlaps, GrainFate fate) {
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
void linkParts(Sides& sides, Tracks& tracks, const Int32Grid& before, const Int32Grid& after,
               const std::map<int32_t, Motion>& motions, Interrupter* interrupter) {
  const auto overlaps = detail::movedOverlaps(before, after, motions, interrupter);
  std::map<Pair, int64_t> mirrored;
  for (const auto& [pair, voxels] : overlaps) mirrored[{pair.second, pair.first}] = voxels;
  const auto add = [&](int32_t first, int32_t second, int64_t voxels) {
    sides.fromBefore[first].insert(second);
    sides.fromAfter[second].insert(first);
    tracks.overlaps.push_back({first, second, voxels, true});
  };
  for (const GrainOverlap& link : linkParts(sides.before, sides.after, overlaps, GrainFate::split))
    add(link.before, link.after, link.voxels);
  for (const GrainOverlap& link : linkParts(sides.after, sides.before, mirrored, GrainFate::merged))
    add(link.after, link.before, link.voxels);
}

/// Says of broken bonds whether their grains are near and whether this is sure, and of bonds of
/// which an end is outside that they are.
void refine(Tracks& tracks, const Sides& sides, const Int32Grid& before, const Int32Grid& after,
            const std::map<int32_t, Motion>& motions, const TrackOptions& options,
            Interrupter* interrupter) {
  std::set<Pair> apart, broken;
  const auto now = [&](const TrackedBond& bond) {
    std::vector<Pair> pairs;
    for (const int32_t a : sides.fromBefore.at(bond.first))
      for (const int32_t b : sides.fromBefore.at(bond.second)) pairs.push_back(std::minmax(a, b));
    return pairs;
  };
  for (const TrackedBond& bond : tracks.bondsBefore)
    if (bond.fate == BondFate::separated) {
      broken.emplace(bond.first, bond.second);
      for (const Pair& pair : now(bond)) apart.insert(pair);
    }
  const std::set<Pair> near = detail::nearPairs(after, apart, options.gap, interrupter),
                       touching = detail::nearPairs(after, apart, 1, interrupter),
                       solid = detail::solidPairs(before, after, broken, motions, interrupter);
  for (TrackedBond& bond : tracks.bondsBefore) {
    if (bond.fate != BondFate::separated) continue;
    const std::vector<Pair> pairs = now(bond);
    const auto any = [&](const std::set<Pair>& of) {
      return std::any_of(pairs.begin(), pairs.end(),
                         [&](const Pair& pair) { return of.count(pair) > 0; });
    };
    if (bond.faces < options.sureFaces || any(touching) || solid.count({bond.first, bond.second}))
      bond.fate = BondFate::undecided;
    else if (any(near))
      bond.fate = BondFate::detached;
  }
  for (auto* bonds : {&tracks.bondsBefore, &tracks.bondsAfter}) {
    const TrackedGrains& grains = bonds == &tracks.bondsBefore ? sides.before : sides.after;
    for (TrackedBond& bond : *bonds)
      for (const int32_t end : {bond.first, bond.second})
        if (grains.at(end).fate == GrainFate::outside) bond.fate = BondFate::outside;
  }
}

std::vector<TrackedGrain> listed(const TrackedGrains& grains) {
  std::vector<TrackedGrain> list;
  for (const auto& [number, grain] : grains) list.push_back(grain);
  return list;
}

Tracks trackMotion(const Int32Grid& before, const Int32Grid& after, const TrackOptions& options,
                   Interrupter* interrupter) {
  for (const Int32Grid* labels : {&before, &after})
    requireCubicVoxels(*labels, "following grains through a motion");
  const GrainSet first = detail::grainSet(before, interrupter),
                 second = detail::grainSet(after, interrupter);
  const auto followed = matchGrains(first, second, *options.motion, interrupter);
  if (!followed)
    throw InvalidInput(
        "no motion is found that brings some grain and its neighbors to such of the later scan: "
        "give labels of the same sample, or a guess of its motion");
  Tracks tracks;
  tracks.motion = options.motion->kind;
  tracks.whole = followed->whole;
  Sides sides{grainsOf(before, interrupter), grainsOf(after, interrupter), {}, {}};
  link(sides, tracks, first, second, *followed, boxOf(before), boxOf(after));
  const auto motions = motionsOf(first, second, *followed);
  linkParts(sides, tracks, before, after, motions, interrupter);
  tracks.lastTrack = number(sides, std::exchange(tracks.overlaps, {}), lastTrackOf(before));
  tracks.bondsBefore = bondsOf(before, before, options.minFaces, interrupter);
  tracks.bondsAfter = bondsOf(after, after, options.minFaces, interrupter);
  const std::set<Pair> pairsBefore = pairsOf(tracks.bondsBefore),
                       pairsAfter = pairsOf(tracks.bondsAfter);
  judge(tracks.bondsBefore, sides.fromBefore, pairsAfter, BondFate::separated);
  judge(tracks.bondsAfter, sides.fromAfter, pairsBefore, BondFate::created);
  refine(tracks, sides, before, after, motions, options, interrupter);
  tracks.before = listed(sides.before);
  tracks.after = listed(sides.after);
  return tracks;
}

}  // namespace

const char* toString(MotionKind kind) {
  constexpr const char* kNames[] = {"rigid", "affine", "free"};
  return kNames[size_t(kind)];
}

std::optional<MotionKind> motionKindOf(const std::string& name) {
  for (const MotionKind kind : {MotionKind::rigid, MotionKind::affine, MotionKind::free})
    if (name == toString(kind)) return kind;
  return std::nullopt;
}

MoveOf moveOf(const Tracks& tracks) {
  std::map<int32_t, const GrainMove*> moves;  // by the number before
  for (size_t n = 0; n < tracks.before.size(); ++n)
    if (tracks.before[n].fate == GrainFate::kept) moves[tracks.before[n].grain] = &tracks.moves[n];
  return [moves](const TrackedGrain& grain) {
    return grain.fate == GrainFate::kept ? moves.at(grain.track) : nullptr;
  };
}

const char* toString(GrainFate fate) {
  constexpr const char* kNames[] = {"kept", "split", "merged", "vanished",
                                    "new",  "lost",  "outside"};
  return kNames[size_t(fate)];
}

const char* toString(BondFate fate) {
  constexpr const char* kNames[] = {"kept",      "broken",    "new",       "inside", "detached",
                                    "separated", "undecided", "unmatched", "outside"};
  return kNames[size_t(fate)];
}

Tracks track(const Int32Grid& before, const Int32Grid& after, const TrackOptions& options,
             Interrupter* interrupter) {
  check(options);
  if (options.motion) return trackMotion(before, after, options, interrupter);
  Tracks tracks;
  tracks.shift = options.shift ? *options.shift
                               : detail::findShift(detail::labelledVoxels(before),
                                                   detail::labelledVoxels(after), options.maxShift,
                                                   interrupter);
  Sides sides{grainsOf(before, interrupter), grainsOf(after, interrupter), {}, {}};
  const auto first =
      detail::movedLabels(before, tracks.shift, shownBox(after, Coord(0)), interrupter);
  const auto second =
      detail::movedLabels(after, Coord(0), shownBox(before, tracks.shift), interrupter);
  const std::vector<Overlap> overlaps = compare(*first, *second, interrupter).overlaps;
  for (const Overlap& overlap : overlaps) {
    addOverlap(sides.before, overlap.truth, overlap.test, overlap.voxels);
    addOverlap(sides.after, overlap.test, overlap.truth, overlap.voxels);
    if (overlap.truth) tracks.voxelsBefore += overlap.voxels;
    if (overlap.test) tracks.voxelsAfter += overlap.voxels;
    if (!overlap.truth || !overlap.test) continue;
    tracks.commonVoxels += overlap.voxels;
    tracks.overlaps.push_back({overlap.truth, overlap.test, overlap.voxels, false});
  }
  link(sides, tracks.overlaps, options.share);
  judge(sides.before, sides.fromBefore, sides.fromAfter, GrainFate::split, GrainFate::merged,
        GrainFate::vanished);
  judge(sides.after, sides.fromAfter, sides.fromBefore, GrainFate::merged, GrainFate::split,
        GrainFate::appeared);
  tracks.lastTrack = number(sides, tracks.overlaps, lastTrackOf(before));
  tracks.before = listed(sides.before);
  tracks.after = listed(sides.after);
  tracks.bondsBefore = bondsOf(before, *first, options.minFaces, interrupter);
  tracks.bondsAfter = bondsOf(after, *second, options.minFaces, interrupter);
  const std::set<Pair> pairsBefore = pairsOf(tracks.bondsBefore),
                       pairsAfter = pairsOf(tracks.bondsAfter);
  judge(tracks.bondsBefore, sides.fromBefore, pairsAfter, BondFate::broken);
  judge(tracks.bondsAfter, sides.fromAfter, pairsBefore, BondFate::created);
  return tracks;
}

BrokenBonds brokenBonds(const Tracks& tracks, int64_t sureFaces) {
  BrokenBonds bonds;
  for (const TrackedBond& bond : tracks.bondsBefore) {
    if (bond.faces < sureFaces) continue;  // of which no broken ones are known
    bonds.kept += bond.fate == BondFate::kept;
    bonds.unknown += bond.fate == BondFate::unmatched || bond.fate == BondFate::undecided;
    bonds.broken += bond.fate == BondFate::broken || bond.fate == BondFate::detached ||
                    bond.fate == BondFate::separated;
  }
  return bonds;
}

Int32Grid::Ptr trackedLabels(const Int32Grid& after, const Tracks& tracks,
                             Interrupter* interrupter) {
  std::vector<Pair> to;
  for (const TrackedGrain& grain : tracks.after) to.emplace_back(grain.grain, grain.track);
  const auto labels = detail::relabelled(after, to, interrupter);
  const Coord& s = tracks.shift;
  const std::string shift =
      std::to_string(s.x()) + "," + std::to_string(s.y()) + "," + std::to_string(s.z());
  removeGraph(*labels);  // of manifolds, should these have been tracked themselves
  labels->insertMeta(kTrackKey, openvdb::StringMetadata(tracks.motion ? std::string("motion ") +
                                                                            toString(*tracks.motion)
                                                                      : "shift " + shift));
  labels->insertMeta(kLastTrackKey, openvdb::Int64Metadata(tracks.lastTrack));
  return labels;
}

}  // namespace vdb_madf
