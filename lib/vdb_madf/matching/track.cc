// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/track.h"

#include <openvdb/Metadata.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_contacts.h"
#include "vdb_madf/labels/detail/relabelled.h"
#include "vdb_madf/labels/label_sizes.h"
#include "vdb_madf/matching/compare.h"
#include "vdb_madf/matching/detail/motion_tracks.h"
#include "vdb_madf/matching/detail/moved_labels.h"
#include "vdb_madf/matching/detail/rigid_shift.h"
#include "vdb_madf/matching/detail/track_sides.h"
#include "vdb_madf/segmentation/graph_metadata.h"

namespace vdb_madf {

namespace {

using detail::Links;
using detail::Sides;
using detail::TrackedGrains;

/// What is not looked at has to be as it is when nobody asks for it.
void checkUsed(const TrackOptions& options) {
  const TrackOptions usual;
  const auto refuse = [](const char* what, const char* why) {
    throw InvalidInput(std::string(what) + why + ": leave it out");
  };
  if (options.motion) {
    const char* const why = " is of grains that lie on each other, and a motion does without";
    if (options.share != usual.share) refuse("the share of common voxels", why);
    if (options.maxShift != usual.maxShift) refuse("a largest shift", why);
    return;
  }
  const char* const why = " is of bonds that a motion breaks, and none is given";
  if (options.gap != usual.gap) refuse("the gap of a detached bond", why);
  if (options.sureFaces != usual.sureFaces) refuse("how many faces break for sure", why);
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

void link(Sides& sides, std::vector<GrainOverlap>& overlaps, double share) {
  for (GrainOverlap& overlap : overlaps) {
    const int64_t smaller = std::min(sides.before.at(overlap.before).sharedVoxels,
                                     sides.after.at(overlap.after).sharedVoxels);
    overlap.isLink = double(overlap.voxels) >= share * double(smaller);
    if (!overlap.isLink) continue;
    sides.link(overlap.before, overlap.after);
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

}  // namespace

void checkOptions(const TrackOptions& options) {
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
  checkUsed(options);
}

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
  checkOptions(options);
  if (options.motion) {
    // The grids are the caller's.
    const auto shared = [](const Int32Grid& labels) {
      return Int32Grid::ConstPtr(Int32Grid::ConstPtr(), &labels);
    };
    return detail::motionTracks(shared(before), shared(after), options, interrupter);
  }
  Tracks tracks;
  tracks.shift = options.shift ? *options.shift
                               : detail::findShift(detail::labelledVoxels(before),
                                                   detail::labelledVoxels(after), options.maxShift,
                                                   interrupter);
  Sides sides{grainsOf(before, interrupter), grainsOf(after, interrupter), {}, {}};
  const auto first =
      detail::movedLabels(before, tracks.shift, {storedDomain(after), Coord(0)}, interrupter);
  const auto second =
      detail::movedLabels(after, Coord(0), {storedDomain(before), tracks.shift}, interrupter);
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
  tracks.lastTrack = detail::numberTracks(sides, tracks.overlaps, detail::lastTrackOf(before));
  tracks.before = detail::listed(sides.before);
  tracks.after = detail::listed(sides.after);
  const auto bondsOf = [&](const Int32Grid& labels, const Int32Grid& shared) {
    return detail::bondsOf(detail::labelContacts(labels, interrupter),
                           detail::labelContacts(shared, interrupter), options.minFaces);
  };
  tracks.bondsBefore = bondsOf(before, *first);
  tracks.bondsAfter = bondsOf(after, *second);
  const auto pairsBefore = detail::pairsOf(tracks.bondsBefore),
             pairsAfter = detail::pairsOf(tracks.bondsAfter);
  detail::judgeBonds(tracks.bondsBefore, sides.fromBefore, pairsAfter, BondFate::broken);
  detail::judgeBonds(tracks.bondsAfter, sides.fromAfter, pairsBefore, BondFate::created);
  return tracks;
}

Tracks track(const AnyLabels& before, const AnyLabels& after, const TrackOptions& options,
             Interrupter* interrupter) {
  checkOptions(options);
  if (options.motion) return detail::motionTracks(before, after, options, interrupter);
  const auto *const first = std::get_if<Int32Grid::ConstPtr>(&before),
                    *const second = std::get_if<Int32Grid::ConstPtr>(&after);
  if (!first || !second)
    throw InvalidInput("labels in slabs are followed with a motion alone: say which one");
  return track(**first, **second, options, interrupter);
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

namespace {

/// Gives labels the numbers of their tracks.
struct Renumbering {
  std::vector<detail::LabelPair> to;
  std::string how;
  int32_t last = 0;

  explicit Renumbering(const Tracks& tracks) : last(tracks.lastTrack) {
    for (const TrackedGrain& grain : tracks.after) to.emplace_back(grain.grain, grain.track);
    const Coord& s = tracks.shift;
    how = tracks.motion ? std::string("motion ") + toString(*tracks.motion)
                        : "shift " + std::to_string(s.x()) + "," + std::to_string(s.y()) + "," +
                              std::to_string(s.z());
  }

  Int32Grid::Ptr operator()(const Int32Grid& labels, Interrupter* interrupter) const {
    const Int32Grid::Ptr result = detail::relabelled(labels, to, interrupter);
    removeGraph(*result);  // of manifolds, should these have been tracked themselves
    result->insertMeta(kTrackKey, openvdb::StringMetadata(how));
    result->insertMeta(kLastTrackKey, openvdb::Int64Metadata(last));
    return result;
  }
};

}  // namespace

Int32Grid::Ptr trackedLabels(const Int32Grid& after, const Tracks& tracks,
                             Interrupter* interrupter) {
  return Renumbering(tracks)(after, interrupter);
}

AnyLabels trackedLabels(const AnyLabels& after, const Tracks& tracks, Interrupter* interrupter) {
  const Renumbering renumbered(tracks);
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&after))
    return Int32Grid::ConstPtr(renumbered(**whole, interrupter));
  LabelSlabs slabs = std::get<LabelSlabs>(after);
  slabs.about = renumbered(*slabs.about, interrupter);
  slabs.read = [read = slabs.read, renumbered](size_t slab, Interrupter* reading) {
    return renumbered(*read(slab, reading), reading);
  };
  return slabs;
}

}  // namespace vdb_madf
