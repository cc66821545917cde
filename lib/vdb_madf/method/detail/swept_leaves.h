// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"
#include "vdb_madf/method/detail/passage.h"

namespace vdb_madf::detail {

/// A value for each voxel that sweeps go through: those of the object by their ranks and, in a
/// region, those of unknown voxels.
template <typename T>
struct SweptValues {
  VoxelArray<T>& object;
  VoxelArray<T> unknown{};
};

/// The leaves that sweeps go through: those of the object or, in a region, of a passage around it.
class SweptLeaves {
 public:
  SweptLeaves(const LeafIndex& object, const Passage* passage)
      : object_(object), passage_(passage) {}

  const LeafIndex& object() const { return object_; }
  const LeafIndex& index() const { return passage_ ? passage_->index() : object_; }
  size_t unknownVoxels() const {
    return size_t(index().voxelCount()) - size_t(object_.voxelCount());
  }
  /// The leaf of the object that a leaf of index() is; another one, if it has no voxel of it.
  uint32_t objectLeaf(uint32_t leaf) const {
    if (!passage_) return leaf;
    return std::min(passage_->objectLeavesBefore(leaf), uint32_t(object_.leafCount()) - 1);
  }
  /// Does a leaf take part in a pass (Passage)? Each does if there is no passage.
  bool carries(int pass, uint32_t leaf) const { return !passage_ || passage_->carries(pass, leaf); }
  bool anyCarries(int pass, const std::vector<uint32_t>& leaves) const {
    return std::any_of(leaves.begin(), leaves.end(),
                       [&](uint32_t leaf) { return carries(pass, leaf); });
  }

  /// The values of a leaf's 512 voxels; 0 where there is none.
  template <typename T>
  void expand(uint32_t leaf, const SweptValues<T>& values, T* dense) const {
    expand(leaf, values.object, passage_ ? values.unknown.data() + unknownBefore(leaf) : nullptr,
           dense);
  }
  /// Expands a leaf with one value for all unknown voxels.
  template <typename T>
  void expand(uint32_t leaf, const VoxelArray<T>& ofObject, T ofUnknown, T* dense) const {
    std::array<T, 512> same;
    if (passage_) same.fill(ofUnknown);
    expand(leaf, ofObject, same.data(), dense);
  }
  /// The way back; those of the object alone, if `objectOnly`.
  template <typename T>
  void pack(uint32_t leaf, const T* dense, bool objectOnly, SweptValues<T>& values) const {
    const uint32_t own = objectLeaf(leaf);
    if (!passage_ || passage_->hasObject(leaf))
      packLeaf(object_.mask(own), dense, values.object.data() + object_.firstRank(own));
    if (!passage_ || objectOnly) return;
    packLeaf(unknownMask(leaf), dense, values.unknown.data() + unknownBefore(leaf));
  }

 private:
  template <typename T>
  void expand(uint32_t leaf, const VoxelArray<T>& ofObject, const T* ofUnknown, T* dense) const {
    const uint32_t own = objectLeaf(leaf);
    if (!passage_ || passage_->hasObject(leaf)) {
      expandLeaf(object_.mask(own), ofObject.data() + object_.firstRank(own), dense);
      const LeafIndex::Mask unknown = passage_ ? unknownMask(leaf) : LeafIndex::Mask{};
      if (!anyVoxel(unknown)) return;
      T more[512];
      expandLeaf(unknown, ofUnknown, more);
      for (size_t i = 0; i < 512; ++i) dense[i] |= more[i];
    } else {
      expandLeaf(index().mask(leaf), ofUnknown, dense);
    }
  }
  LeafIndex::Mask unknownMask(uint32_t leaf) const {
    if (!passage_->hasObject(leaf)) return index().mask(leaf);
    return without(index().mask(leaf), object_.mask(objectLeaf(leaf)));
  }
  size_t unknownBefore(uint32_t leaf) const {
    return index().firstRank(leaf) - object_.firstRank(passage_->objectLeavesBefore(leaf));
  }

  const LeafIndex& object_;
  const Passage* passage_;  // null: the object alone
};

}  // namespace vdb_madf::detail
