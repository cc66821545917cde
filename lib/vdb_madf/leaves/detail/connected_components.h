// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/pages.h"
#include "vdb_madf/leaves/detail/label_masks.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// The 6-connected components of X, or of the voxels of each label. Found from masks alone: flood
/// fill by words within a leaf, then union over the faces between leaves; memory is per leaf, not
/// per voxel.
class ConnectedComponents {
 public:
  struct Piece {  ///< a component within one leaf
    LeafIndex::Mask mask;
    uint32_t label;  ///< 1 if there are no labels
    uint32_t component;
  };

  /// @throw Interrupted
  explicit ConnectedComponents(const LeafIndex& index, Interrupter* interrupter = nullptr);
  /// Voxels without label belong to no component. @throw Interrupted
  ConnectedComponents(const LeafIndex& index, const LabelMasks& labels,
                      Interrupter* interrupter = nullptr);

  uint32_t count() const { return count_; }
  /// Component of a voxel that has one, 0 .. count() - 1.
  uint32_t componentOf(VoxelId id) const;

  /// The pieces of a leaf.
  const Piece* begin(size_t leaf) const { return pieces_.data() + firstPiece_[leaf]; }
  const Piece* end(size_t leaf) const { return pieces_.data() + firstPiece_[leaf + 1]; }

 private:
  void find(const LeafIndex& index, const LabelMasks* labels, Interrupter* interrupter);
  void findPieces(const LeafIndex& index, const LabelMasks* labels, Interrupter* interrupter);
  void joinPieces(const LeafIndex& index, DisjointSets& sets, Interrupter* interrupter) const;
  void joinFaces(uint32_t leaf, uint32_t next, size_t axis, DisjointSets& sets) const;
  void numberComponents(DisjointSets& sets);

  std::vector<Piece, PageAllocator<Piece>> pieces_;
  std::vector<uint32_t> firstPiece_;  // per leaf; one more at the end
  uint32_t count_ = 0;
};

}  // namespace vdb_madf::detail
