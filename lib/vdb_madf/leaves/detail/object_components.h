// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// The 6-connected components of X. Found from masks alone: flood fill by words within a leaf, then
/// union over the faces between leaves; memory is per leaf, not per voxel.
class ObjectComponents {
 public:
  /// @throw Interrupted
  explicit ObjectComponents(const LeafIndex& index, Interrupter* interrupter = nullptr);

  uint32_t count() const { return count_; }
  /// Component of an object voxel, 0 .. count() - 1.
  uint32_t componentOf(VoxelId id) const;

 private:
  struct Piece {  // a component within one leaf
    LeafIndex::Mask mask;
    uint32_t component;
  };
  void findPieces(const LeafIndex& index, Interrupter* interrupter);
  void joinPieces(const LeafIndex& index, DisjointSets& sets) const;
  void joinFaces(uint32_t leaf, uint32_t next, int axis, DisjointSets& sets) const;
  void numberComponents(DisjointSets& sets);

  std::vector<Piece> pieces_;
  std::vector<uint32_t> firstPiece_;  // per leaf; one more at the end
  uint32_t count_ = 0;
};

}  // namespace vdb_madf::detail
