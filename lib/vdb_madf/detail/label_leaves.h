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
  /// The voxels of a leaf that have a label.
  LeafIndex::Mask maskOf(size_t leaf, int32_t label) const;
  /// Are all 512 voxels of the leaf labelled alike, and all that touch them the same, with no other
  /// label in the six neighbours? Then no surface is the leaf's.
  bool isInterior(size_t leaf) const;

 private:
  LeafIndex index_;
  std::vector<const int32_t*> values_;  // null: a part of a tile
  std::vector<int32_t> singles_;
};

/// The labels in and around a leaf, -4 to 13 along each axis from its origin, as short codes: 0 for
/// none, else a number that stands for a label as long as the leaf is loaded. One per thread.
///
/// Most leaves lie away from all interfaces: their voxels have one label, and so have those of the
/// next leaves up x, y and z. No voxel has a partner of another label up to 8 voxels further then,
/// and which voxels have the leaf's label and which have any says all.
class LabelWindow {
 public:
  using Code = uint16_t;
  static constexpr int kBegin = -4, kEnd = 14;  ///< of x, y and z
  static constexpr int kLanes = 4;              ///< codes in a word
  static constexpr Code kMixed = 0xffff;        ///< no code: there are fewer voxels

  explicit LabelWindow(const LabelLeaves& labels)
      : labels_(&labels), neighborhood_(labels.index()) {}

  void load(size_t leaf);
  /// The leaf lies away from interfaces as above; its label has code 1. No codes are known then.
  bool oneLabel() const { return oneLabel_; }
  /// With oneLabel(): bit z + 8: voxel (x, y, z) has that label.
  uint32_t same(int x, int y) const { return same_[size_t((x - kBegin) * kSide + (y - kBegin))]; }
  /// The codes from (x, y, z) on along z.
  const Code* row(int x, int y, int z) const {
    return codes_.data() + ((x - kBegin) * kSide + (y - kBegin)) * kRow + (z + 8);
  }
  /// Bit z + 8: voxel (x, y, z) is labelled.
  uint32_t labelled(int x, int y) const {
    return labelled_[size_t((x - kBegin) * kSide + (y - kBegin))];
  }
  /// The code that all labelled voxels of a row have, else kMixed. Of a row without: whatever.
  Code rowCode(int x, int y) const {
    return rowCodes_[size_t((x - kBegin) * kSide + (y - kBegin))];
  }
  int32_t label(Code code) const { return names_[code]; }

 private:
  static constexpr int kSide = kEnd - kBegin;
  static constexpr int kRow = 24;  // z from -8 to 15: three whole leaves

  Code codeOf(int32_t label);
  using Bits = std::array<uint32_t, (kEnd - kBegin) * (kEnd - kBegin)>;
  static void copyMasks(const std::array<const LeafIndex::Mask*, 3>& masks, int dx, int dy,
                        Bits& bits);
  void copyCodes(uint32_t leaf, int dx, int dy, int dz);

  const LabelLeaves* labels_;
  LeafNeighborhood neighborhood_;
  bool oneLabel_ = false;
  std::vector<int32_t> names_;
  std::unordered_map<int32_t, Code> codesByName_;  // used when there are many
  std::array<Code, kSide * kSide * kRow + kLanes> codes_{};
  Bits labelled_{}, same_{};
  std::array<Code, kSide * kSide> rowCodes_{};
};

}  // namespace vdb_madf::detail
