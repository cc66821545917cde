// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/method/detail/refill.h"
#include "vdb_madf/slabs/cuts/site_offers.h"
#include "vdb_madf/slabs/cuts/slab_smoothing.h"

// Connected pieces that go on beyond the cuts of a slab; and the second part of tidy() in slabs:
// what is not connected with the anchor of its grain goes to a neighbor. The few voxels of such
// pieces, of all slabs, are gathered.

namespace vdb_madf::detail {

/// A voxel beside a cut: which piece of its slab it is in.
struct FacePiece {
  int32_t x, y;
  uint32_t piece, label;
};

/// The voxels beside a cut, by leaf column, then x, y.
std::vector<FacePiece> facePieces(const LeafIndex& index, const ConnectedComponents& components,
                                  const Cut& cut);

/// Pieces of two slabs, one upon the other, that are one.
struct PieceJoin {
  uint32_t below, above;
};
/// The pieces on either side of a cut that are one, each pair once.
std::vector<PieceJoin> pieceJoins(const std::vector<FacePiece>& below,
                                  const std::vector<FacePiece>& above);

/// Joins the pieces of all slabs.
class PieceUnion {
 public:
  /// The pieces of the next slab, from the lowest on, and how they are joined to those of the one
  /// below.
  void add(size_t pieces, const std::vector<PieceJoin>& joins);
  /// A number of what a piece is part of, below size().
  uint32_t find(size_t slab, uint32_t piece) { return sets_.find(first_[slab] + piece); }
  uint32_t size() const { return first_.back(); }
  int64_t count() const { return int64_t(first_.back()) - joins_; }  ///< of joined pieces

 private:
  std::vector<uint32_t> first_{0};
  DisjointSets sets_{0};
  int64_t joins_ = 0;
};

/// Which pieces of a slab hold the anchor of their label?
std::vector<char> piecesWithAnchor(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                   const ConnectedComponents& components, const Anchors& anchors);

/// A voxel that has lost its label.
struct LooseVoxel {
  Coord position;
  uint32_t label;       ///< that it lost; then the one it gets
  LabelsAround around;  ///< of neighbors that are not loose
};

/// What lies beyond a cut: the pieces beside it, and which of the pieces of their slab hold an
/// anchor, be it in another slab.
struct BeyondPieces {
  std::vector<FacePiece> face;
  std::vector<char> isHeld;
};

/// What a leaf has of a piece.
struct LeafPiece {
  uint32_t leaf;
  ConnectedComponents::Piece piece;
};
/// What leaves have of the pieces of a slab that hold no anchor in it, by leaf.
std::vector<LeafPiece> piecesWithoutAnchor(const LeafIndex& index,
                                           const ConnectedComponents& components,
                                           const std::vector<char>& hasAnchor);

/// The loose voxels of a slab: those of the pieces in `loose`, by leaf, which are all that hold no
/// anchor in any slab.
std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                    const std::vector<LeafPiece>& loose, int begin, int end,
                                    const BeyondPieces& below, const BeyondPieces& above);

/// Gives all of them a label (refill.h); those that no round reaches keep what they lost. Sorts
/// them by position.
void refillAll(std::vector<LooseVoxel>& loose, Interrupter* interrupter);

}  // namespace vdb_madf::detail
