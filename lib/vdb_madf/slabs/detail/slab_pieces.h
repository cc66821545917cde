// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/slabs/detail/bytes.h"
#include "vdb_madf/slabs/detail/slab_smoothing.h"

// The second part of tidy() in slabs: what is not connected with the anchor of its grain goes to a
// neighbor. The few voxels of such pieces, of all slabs, are gathered.

namespace vdb_madf::detail {

/// The connected pieces of the labels of a slab.
struct SlabPieces {
  struct FaceVoxel {
    int32_t x, y;
    uint32_t piece;
  };
  std::vector<uint32_t> label;  ///< of each piece
  std::vector<char> held;       ///< does it hold the anchor of its label?
  /// The voxels of pieces in the lowest and highest layer, by leaf column, then x, y.
  std::vector<FaceVoxel> lowest, highest;

  SlabPieces() = default;
  SlabPieces(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
             const ConnectedComponents& components, const Anchors& anchors, int begin, int end);

  void writeTo(ByteWriter& bytes) const;
  static SlabPieces readFrom(ByteReader& bytes);
};

/// Joins the pieces of all slabs.
class PieceUnion {
 public:
  /// Of the next slab, from the lowest on; \p before: those that were added last, if any.
  void add(const SlabPieces& pieces, const SlabPieces* before);
  /// Is a piece of a slab part of one that holds an anchor? After the last slab.
  bool isHeld(size_t slab, uint32_t piece);
  int64_t count() const { return int64_t(first_.back()) - joins_; }  ///< of joined pieces

 private:
  std::vector<uint32_t> first_{0};
  DisjointSets sets_{0};
  std::vector<char> held_;
  int64_t joins_ = 0;
  bool joined_ = false;
};

/// A voxel that has lost its label.
struct LooseVoxel {
  Coord position;
  uint32_t label;      ///< that it lost; then the one it gets
  uint32_t around[6];  ///< labels of its neighbors; 0: none, or loose itself
};

/// The loose voxels of a slab; \p below and \p above: the slabs beside it, null if there are none.
std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                    const ConnectedComponents& components, size_t slab, int begin,
                                    int end, const SlabPieces* below, const SlabPieces* above,
                                    PieceUnion& pieces);

/// Gives all of them a label, in synchronous rounds; those that no round reaches keep what they lost.
/// Sorts them by position.
void refill(std::vector<LooseVoxel>& loose);

}  // namespace vdb_madf::detail
