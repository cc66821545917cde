// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "vdb_madf/detail/leaf_neighborhood.h"
#include "vdb_madf/leaf_index.h"

namespace vdb_madf::detail {

/// A label grid by leaves. Labelled are the active voxels, tiles included, of positive value. The
/// grid must outlive it.
class LabelLeaves {
 public:
  LabelLeaves(const Int32Grid& labels, Interrupter* interrupter);

  const LeafIndex& index() const { return index_; }
  /// The label that all labelled voxels of a leaf have, 0 if they differ.
  int32_t single(size_t leaf) const { return singles_[leaf]; }
  int32_t label(size_t leaf, int offset) const {
    return singles_[leaf] ? singles_[leaf] : values_[leaf][offset];
  }
  /// Are all 512 voxels of the leaf labelled alike, and all that touch them the same, with no other
  /// label in the six neighbours? Then no surface is the leaf's.
  bool isInterior(size_t leaf) const;

 private:
  LeafIndex index_;
  std::vector<const int32_t*> values_;  // null: a part of a tile
  std::vector<int32_t> singles_;
};

/// The labels in and around a leaf, -4 to 13 along each axis from its origin, as short codes: 0 for
/// none, else a number that stands for a label as long as the leaf is loaded. Most windows hold one
/// label only: its code is 1, and which voxels are labelled says all. One per thread.
class LabelWindow {
 public:
  using Code = uint16_t;
  static constexpr int kBegin = -4, kEnd = 14;  ///< of x, y and z
  static constexpr int kLanes = 4;              ///< codes in a word
  static constexpr Code kMixed = 0xffff;        ///< no code: there are fewer voxels

  explicit LabelWindow(const LabelLeaves& labels)
      : labels_(&labels), neighborhood_(labels.index()) {}

  void load(size_t leaf);
  /// All voxels labelled in the 27 leaves have one label.
  bool oneLabel() const { return oneLabel_; }
  /// The codes from (x, y, z) on along z. Not with oneLabel().
  const Code* row(int x, int y, int z) const {
    return codes_.data() + ((x - kBegin) * kSide + (y - kBegin)) * kRow + (z + 8);
  }
  /// Bit z + 8: voxel (x, y, z) is labelled.
  uint32_t labelled(int x, int y) const {
    return labelled_[size_t((x - kBegin) * kSide + (y - kBegin))];
  }
  /// The code that all labelled voxels of a row have, else kMixed. Of a row without: whatever.
  Code rowCode(int x, int y) const {
    return oneLabel_ ? Code(1) : rowCodes_[size_t((x - kBegin) * kSide + (y - kBegin))];
  }
  int32_t label(Code code) const { return names_[code]; }

 private:
  static constexpr int kSide = kEnd - kBegin;
  static constexpr int kRow = 24;  // z from -8 to 15: three whole leaves

  Code codeOf(int32_t label);
  void copyMasks(const uint32_t* leaves, int dx, int dy);
  void copyCodes(uint32_t leaf, int dx, int dy, int dz);

  const LabelLeaves* labels_;
  LeafNeighborhood neighborhood_;
  bool oneLabel_ = false;
  std::vector<int32_t> names_;
  std::unordered_map<int32_t, Code> codesByName_;  // used when there are many
  std::array<Code, kSide * kSide * kRow + kLanes> codes_{};
  std::array<uint32_t, kSide * kSide> labelled_{};
  std::array<Code, kSide * kSide> rowCodes_{};
};

}  // namespace vdb_madf::detail
