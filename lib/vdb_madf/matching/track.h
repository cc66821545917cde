// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/matching/match_grains.h"

namespace vdb_madf {

/// How grains of two scans are linked.
struct TrackOptions {
  std::optional<Coord> shift;  ///< of the sample, in voxels, from before to after; absent: is found
  int maxShift = 10;           ///< that is looked for, along each axis; 0 to kMaxShift
  /// The share of the smaller grain's voxels that two grains must have in common to be linked; (0,
  /// 1].
  double share = 0.5;
  int64_t minFaces = 1;  ///< grains that share fewer voxel faces have no bond
  /// The sample was turned or strained: grains are followed by matchGrains(), and the shift is not
  /// looked at.
  std::optional<MatchOptions> motion = {};
  int gap = 2;  ///< voxels, with a motion: grains of a broken bond that are near; 1 to kMaxGap
  /// A bond that had fewer faces is undecided, with a motion, and not broken: so many may a rough
  /// surface open or close.
  int64_t sureFaces = 16;
};

constexpr int kMaxShift = 256, kMaxGap = 16;

/// @throw InvalidInput if an option is out of range, or differs from the default though nothing
///   uses it: share and maxShift with a motion, gap and sureFaces without one
void checkOptions(const TrackOptions& options);

/// What becomes of a grain, or where it comes from.
enum class GrainFate {
  kept,      ///< linked with one grain, which is linked with it alone
  split,     ///< before: linked with several; after: with one that is
  merged,    ///< before: linked with one that is with several; after: with several
  vanished,  ///< before: linked with none
  appeared,  ///< after: linked with none
  lost,      ///< before, with a motion: it may be there, but is not followed
  outside  ///< no voxel lies in what both volumes show; with a motion: some would, or its scan ends
           ///< within it
};

/// What becomes of a bond, or where it comes from; by the faces in what both volumes show.
enum class BondFate {
  kept,      ///< a grain linked with the one end is bonded to another that is linked with the other
  broken,    ///< before: both ends are linked, but not so
  created,   ///< after: both ends are linked, but not so; with a motion: surely
  inside,    ///< ... and a grain is linked with both ends
  detached,  ///< with a motion: broken, and the ends have voxels within the gap
  separated,  ///< with a motion: broken, and they have not
  undecided,  ///< with a motion: not bonded there, but the ends touch, or something solid is where
              ///< the bond is, or it is of fewer than sureFaces
  unmatched,  ///< an end is linked with none
  outside     ///< fewer than minFaces (or none) of its faces lie in what both volumes show
};

const char* toString(GrainFate fate);  ///< "kept", ..., "new" for appeared
const char* toString(BondFate fate);   ///< "kept", ..., "new" for created

/// A grain of one of the two scans, and what became of it.
struct TrackedGrain {
  int32_t grain = 0;
  GrainFate fate = GrainFate::outside;
  int64_t voxels = 0;        ///< all
  int64_t sharedVoxels = 0;  ///< in what both volumes show
  int64_t links = 0;         ///< grains that it is linked with
  int32_t partner = 0;  ///< most voxels in common, linked or not (tie: smaller number); 0: none
  int64_t overlapVoxels = 0;  ///< in common with the partner
  int32_t track = 0;          ///< its number through time: before, its own; after, see track()
};

/// How a grain has moved, with a motion.
struct GrainMove {
  double confidence = 0;  ///< see matchGrains(); 0: it was not followed
  /// Its neighbors say where it should be. Of one that was not followed displacement and gradient
  /// are theirs.
  bool isPlaced = false;
  openvdb::Vec3d center{0, 0, 0};  ///< of mass, before, in index coordinates
  /// A scan ends within it, before or after: its center is that of what is seen of it.
  bool isCut = false;
  openvdb::Vec3d displacement{0, 0, 0};    ///< of the center, in voxels; if cut, as neighbors say
  double miss = 0;                         ///< from where neighbors say it is, in voxels
  int neighbors = 0;                       ///< that the gradient is from
  std::optional<openvdb::Mat3d> gradient;  ///< see FollowedGrain
};

/// Two grains that have voxels in common.
struct GrainOverlap {
  int32_t before = 0, after = 0;
  int64_t voxels = 0;
  bool isLink = false;
};

/// A bond of one of the two scans, and what became of it.
struct TrackedBond {
  int32_t first = 0, second = 0;
  int64_t faces = 0;        ///< all
  int64_t sharedFaces = 0;  ///< in what both volumes show
  BondFate fate = BondFate::unmatched;
};

/// Grains and bonds of two scans, and how they go together.
struct Tracks {
  Coord shift;               ///< voxel p before is p + shift after
  int64_t voxelsBefore = 0;  ///< labeled, in what both volumes show
  int64_t voxelsAfter = 0;
  int64_t commonVoxels = 0;                          ///< labeled in both
  std::vector<TrackedGrain> before, after;           ///< ascending
  std::vector<GrainOverlap> overlaps;                ///< by before, then after
  std::vector<TrackedBond> bondsBefore, bondsAfter;  ///< by first, then second
  int32_t lastTrack = 0;  ///< the largest number of a grain so far; 0: there is none

  /// If it was asked for; then there is no shift, and no voxel counts as common.
  std::optional<MotionKind> motion;
  std::optional<Motion> whole;   ///< with a motion, unless it is free
  std::vector<GrainMove> moves;  ///< with a motion: of before
};

const char* toString(MotionKind kind);  ///< "rigid", "affine", "free"
/// The kind of this name, if there is one.
std::optional<MotionKind> motionKindOf(const std::string& name);

/// Tells how a grain of either side has moved, with a motion; null if it was not kept.
using MoveOf = std::function<const GrainMove*(const TrackedGrain&)>;
MoveOf moveOf(const Tracks& tracks);

/// Bonds before that tell of breaking: both ends are followed, or one is lost, and they are of so
/// many faces that a rough surface does not hide it (TrackOptions::sureFaces).
struct BrokenBonds {
  int64_t kept = 0, broken = 0;
  int64_t unknown = 0;  ///< it is undecided, or an end is lost

  int64_t all() const { return kept + broken + unknown; }
};
BrokenBonds brokenBonds(const Tracks& tracks, int64_t sureFaces = 0);

/// Follows grains from one label grid to a later one of the same voxels, between which the sample
/// may have moved by whole voxels. Labels are the active voxels, tiles included, of positive value.
///
/// The shift, if it is not given, is the one that most labeled voxels share (detail/rigid_shift.h:
/// findShift()). What both volumes show is the one's domain, box or region, in that of the
/// other; where a domain is unknown, all. Two grains are linked if their common voxels are at least
/// `share` of those that the smaller of them has there. The track of a grain after: links in
/// descending order of their voxels (then by ascending numbers) give the number of the grain before
/// to the grain after, unless either has been used; what is left gets numbers above all of before,
/// in ascending order; if before are tracked labels, above all that their series has had.
/// With a motion matchGrains() says which grains are linked, and what both volumes show are the
/// grains that would lie wholly in the other's domain where their neighbors say. Besides, grains
/// that were not followed are linked with the one that half of their voxels or more lie in where
/// neighbors say (and a tenth of its voxels at least): if there are several and their volumes sum
/// up to 0.6 to 1.6 of its own, or, with its partner, nearer to its own than that alone. So they
/// are split or merged.
/// Deterministic. Memory: a copy of each grid, and per pair of grains that meet.
/// @throw InvalidInput as checkOptions(), or if a limit of leaf_index.h is exceeded; with a
///   motion if none is found, or voxels are no cubes; Interrupted.
Tracks track(const Int32Grid& before, const Int32Grid& after, const TrackOptions& options = {},
             Interrupter* interrupter = nullptr);

/// In memory, or in slabs, whose domain is known: with a motion. Memory: that of the grains and of
/// some slabs, so many as a slab of the other scan comes to lie in when it is moved.
/// @throw as above; what reading throws
Tracks track(const AnyLabels& before, const AnyLabels& after, const TrackOptions& options,
             Interrupter* interrupter = nullptr);

/// The labels after with the numbers of their tracks, and kTrackKey and kLastTrackKey.
Int32Grid::Ptr trackedLabels(const Int32Grid& after, const Tracks& tracks,
                             Interrupter* interrupter = nullptr);
/// Labels in slabs get the numbers of their tracks when they are read.
AnyLabels trackedLabels(const AnyLabels& after, const Tracks& tracks,
                        Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
