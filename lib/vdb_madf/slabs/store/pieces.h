// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"
#include "vdb_madf/method/critical_point.h"
#include "vdb_madf/method/detail/foreign_sites.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/slabs/cuts/slab_exits.h"
#include "vdb_madf/slabs/cuts/slab_pieces.h"
#include "vdb_madf/slabs/cuts/slab_smoothing.h"
#include "vdb_madf/slabs/store/bytes.h"

// All that steps leave in scratch for later ones, and send to other slabs: one table of names,
// types and lifetimes. What is not in it cannot be written (slab_store.h).

namespace vdb_madf::detail {

class ColumnSteps;
struct ClassGraph;
struct ComponentBall;
struct OpenGraph;
struct SlabPart;
struct SlabTerminals;
// Types of tidy_steps.h, slab_map.h, slab_completion.cc, slab_filter.cc, slab_graph.cc,
// slab_labels.cc and slab_remerge.cc.
struct Largest;
struct FaceChange;
struct CompletionState;
struct PlayedWindow;
struct SizedBall;
struct BallCounts;
struct TerminalExits;
struct BallAnswer;
struct HeldPieces;
struct AnchorCandidate;
struct CountedLabel;
struct PartFacts;

/// The steps of slabs, in their order. (remergeSlabs() and mergingSweep() begin with `read` and go
/// on with `anchors`; a filter by gamma has `cells` to `keptMap`; a region has `distances` in place
/// of `columns` to `offersDown`, and none of `keptUp`, `keptDown`.)
enum class Step {
  read,
  cavities,
  columns,
  columnsUp,
  columnsDown,
  distances,
  offers,
  offersUp,
  offersDown,
  cells,
  balls,
  components,
  kept,
  keptUp,
  keptDown,
  keptMap,
  flow,
  contacts,
  answers,
  roots,
  parts,
  anchors,
  rims,
  smoothing,
  joins,
  loose,
  labels,
  never  ///< goes with the scratch, or is removed by hand
};

/// Who sends a message to a slab.
enum class From { below, above, neighbors, all, root, toRoot };

/// A piece or a message by its name.
struct StoredName {
  const char* name;
  Step last;  ///< once a slab has done this step, it forgets its own one, or those that came to it
  int part = -1;

  /// The name of a piece of a slab.
  std::string of(size_t slab) const {
    return (part < 0 ? name : name + ("-" + std::to_string(part))) + "-" + std::to_string(slab);
  }
};

/// What a slab leaves for its later steps. T: a trivial type, a vector or VoxelArray of one, or a
/// type with storedFields() (bytes.h).
template <typename T>
struct Piece : StoredName {
  constexpr Piece(const char* pieceName, Step lastStep) : StoredName{pieceName, lastStep} {}
  /// The piece of one window, or of one number of members.
  constexpr Piece at(int which) const {
    Piece piece = *this;
    piece.part = which;
    return piece;
  }
};

/// What slabs send to slabs, or to the root, which is slab 0.
template <typename T>
struct Message : StoredName {
  From from;
  constexpr Message(const char* messageName, From sender, Step lastStep)
      : StoredName{messageName, lastStep}, from(sender) {}
  constexpr Message at(int which) const {
    Message message = *this;
    message.part = which;
    return message;
  }
};

/// T, and no place where it would be deduced.
template <typename T>
struct AsIsType {
  using Type = T;
};
template <typename T>
using AsIs = typename AsIsType<T>::Type;

template <typename T>
using Values = std::vector<T>;
using Leaves = std::vector<LeafIndex::LeafVoxels>;

// Groups stand in the order in which steps write them: after a step, what stands so far is in
// scratch if its last step is still to come.

// How far a slab is: the last step it has done, by number; whether its grids are put.
inline constexpr Piece<int> kDone("step", Step::never);
inline constexpr Piece<char> kPut("put", Step::never);

// The object.
inline constexpr Piece<Leaves> kObject("object", Step::never);
inline constexpr Piece<Leaves> kCavities("cavities", Step::never);
inline constexpr Message<Leaves> kHoles("holes", From::toRoot, Step::never);
inline constexpr Piece<Leaves> kAround("around", Step::never);  // of others; removed after flow

// How far the background of columns is: below a slab's upper cut, above its lower one; beyond its
// cuts.
inline constexpr Piece<ColumnSteps> kColumnsBelowUpper("columns-below-upper", Step::flow);
inline constexpr Piece<ColumnSteps> kColumnsAboveLower("columns-above-lower", Step::flow);
inline constexpr Message<ColumnSteps> kColumnsBeyond("steps", From::neighbors, Step::flow);
inline constexpr Piece<Largest> kLargest("largest", Step::never);

// The balls that may win beyond a cut: what a slab offers, and what comes from beyond.
inline constexpr Piece<Values<ForeignSite>> kOffersUp("offers-up", Step::flow);
inline constexpr Piece<Values<ForeignSite>> kOffersDown("offers-down", Step::flow);
inline constexpr Message<Values<ForeignSite>> kOffersFromBelow("offers-up", From::below,
                                                               Step::flow);
inline constexpr Message<Values<ForeignSite>> kOffersFromAbove("offers-down", From::above,
                                                               Step::flow);

// The filter by gamma.
inline constexpr Message<Values<SizedBall>> kCells("cells", From::all, Step::keptMap);
inline constexpr Piece<Values<ComponentBall>> kElsewhere("elsewhere", Step::keptMap);
inline constexpr Piece<Values<SizedBall>> kSizedBalls("sized-balls", Step::keptMap);
inline constexpr Message<Values<ComponentBall>> kComponents("components", From::toRoot,
                                                            Step::never);
inline constexpr Piece<Values<FacePiece>> kLowestComponents("lowest-components", Step::keptMap);
inline constexpr Message<Values<FacePiece>> kComponentsBelow("highest-components", From::below,
                                                             Step::keptMap);
inline constexpr Message<Values<PieceJoin>> kJoinedComponents("joined-components", From::toRoot,
                                                              Step::never);
inline constexpr Message<Values<Coord>> kRescued("rescued", From::root, Step::never);
inline constexpr Piece<Values<ForeignSite>> kKept("kept-balls", Step::keptMap);
inline constexpr Message<Values<ForeignSite>> kKeptInReach("kept-balls", From::all, Step::keptMap);
inline constexpr Message<BallCounts> kBallCounts("ball-counts", From::toRoot, Step::never);
inline constexpr Piece<Values<ForeignSite>> kKeptUp("kept-up", Step::keptMap);
inline constexpr Piece<Values<ForeignSite>> kKeptDown("kept-down", Step::keptMap);
inline constexpr Message<Values<ForeignSite>> kKeptFromBelow("kept-up", From::below, Step::keptMap);
inline constexpr Message<Values<ForeignSite>> kKeptFromAbove("kept-down", From::above,
                                                             Step::keptMap);

// The map of the kept balls, and its completion, in windows of rounds.
inline constexpr Piece<Values<Coord>> kMapLeaves("map-leaves", Step::flow);
inline constexpr Piece<VoxelArray<VoxelId>> kMapSites("map-sites", Step::flow);
inline constexpr Piece<VoxelArray<int32_t>> kMapPowers("map-powers", Step::flow);
inline constexpr Piece<CompletionState> kCompletion("completion", Step::never);  // .at(window)
inline constexpr Message<Values<FaceChange>> kChanges("changes", From::neighbors,
                                                      Step::never);  // .at(window)
inline constexpr Message<Values<FaceChange>> kFaceStates("faces", From::neighbors, Step::flow);
inline constexpr Piece<PlayedWindow> kPlayed("used-changes", Step::flow);

// Flow: where voxels flow to, and where these terminals lead to.
inline constexpr Piece<VoxelArray<uint32_t>> kFlow("flow", Step::labels);
inline constexpr Piece<SlabTerminals> kTerminals("terminals", Step::parts);
inline constexpr Piece<Values<SlabTerminals::FaceVoxel>> kLowest("lowest", Step::contacts);
inline constexpr Message<Values<SlabTerminals::FaceVoxel>> kHighest("highest", From::below,
                                                                    Step::contacts);
inline constexpr Piece<Values<ManifoldGraph::Edge>> kContacts("contacts", Step::parts);
inline constexpr Message<Values<uint32_t>> kTouched("touched", From::above, Step::parts);
inline constexpr Piece<Values<uint64_t>> kBalls("balls", Step::answers);
inline constexpr Message<TerminalExits> kExits("exits", From::toRoot, Step::never);
inline constexpr Message<Values<Coord>> kPoints("points", From::toRoot, Step::never);
inline constexpr Message<Values<Coord>> kQuestions("questions", From::root, Step::never);
inline constexpr Message<Values<BallAnswer>> kAnswers("answers", From::toRoot, Step::never);
inline constexpr Message<Values<SlabLead>> kLeads("leads", From::root, Step::never);
inline constexpr Message<Values<uint32_t>> kNumbers("numbers", From::root, Step::never);
inline constexpr Message<Values<SlabRoot>> kRootsBelow("roots", From::below, Step::parts);
inline constexpr Piece<SlabPart> kGraphPart("part", Step::never);
inline constexpr Piece<Values<PartFacts>> kPartFacts("known", Step::never);

// The merge. Members write to members, each .at(how many members there are): a run that goes on may
// have another number of them.
// The classes of terminals; where the root joins these, by score or small ones, of nodes.
inline constexpr Piece<Values<uint32_t>> kClasses("classes", Step::never);
inline constexpr Piece<Values<uint32_t>> kGrains("grains", Step::never);  // of terminals; 0: none
inline constexpr Message<ClassGraph> kClassGraph("class-graph", From::toRoot, Step::never);
inline constexpr Piece<OpenGraph> kMergeOpen("merge-open", Step::never);
inline constexpr Piece<Values<Coord>> kMergeDecided("merge-decided", Step::never);
inline constexpr Piece<Values<uint32_t>> kMergeNumbers("merge-numbers", Step::never);
inline constexpr Piece<Values<uint32_t>> kMergeGrains("merge-grains", Step::never);

// Tidying: labels beside the cuts, pieces of labels, and the voxels that lose theirs.
inline constexpr Piece<LeafLabels> kLowestRim("lowest-rim", Step::rims);
inline constexpr Piece<LeafLabels> kHighestRim("highest-rim", Step::rims);
inline constexpr Message<LeafLabels> kRim("rim", From::neighbors, Step::smoothing);
inline constexpr Message<Values<AnchorCandidate>> kAnchors("anchors", From::toRoot, Step::never);
inline constexpr Piece<VoxelArray<uint32_t>> kLabels("labels", Step::labels);
inline constexpr Message<Values<char>> kPieces("pieces", From::toRoot, Step::never);
inline constexpr Piece<Values<LeafPiece>> kWithoutAnchor("pieces-without-anchor", Step::loose);
inline constexpr Piece<Values<FacePiece>> kLowestPieces("lowest-pieces", Step::joins);
inline constexpr Message<Values<FacePiece>> kFacePieces("face-pieces", From::neighbors,
                                                        Step::loose);
inline constexpr Message<Values<PieceJoin>> kJoinedPieces("joined-pieces", From::toRoot,
                                                          Step::never);
inline constexpr Message<HeldPieces> kHeld("held", From::root, Step::never);
inline constexpr Message<Values<LooseVoxel>> kLoose("loose", From::toRoot, Step::never);
inline constexpr Message<Values<LooseVoxel>> kRefilled("refilled", From::root, Step::never);
inline constexpr Message<Values<CountedLabel>> kCounts("counts", From::toRoot, Step::never);

/// Calls forPiece(name) and forMessage(name, from) for what goes before the scratch does.
template <typename P, typename M>
void forEachForgotten(const P& forPiece, const M& forMessage) {
  const auto pieces = [&](const auto&... piece) { (forPiece(piece), ...); };
  const auto messages = [&](const auto&... message) { (forMessage(message, message.from), ...); };
  pieces(kColumnsBelowUpper, kColumnsAboveLower, kOffersUp, kOffersDown, kElsewhere, kSizedBalls,
         kLowestComponents, kKept, kKeptUp, kKeptDown, kMapLeaves, kMapSites, kMapPowers, kPlayed,
         kFlow, kTerminals, kLowest, kContacts, kBalls, kLowestRim, kHighestRim, kLabels,
         kWithoutAnchor, kLowestPieces);
  messages(kColumnsBeyond, kOffersFromBelow, kOffersFromAbove, kCells, kComponentsBelow,
           kKeptInReach, kKeptFromBelow, kKeptFromAbove, kFaceStates, kHighest, kTouched,
           kRootsBelow, kRim, kFacePieces);
}

}  // namespace vdb_madf::detail
