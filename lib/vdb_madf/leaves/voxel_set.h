// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf {

/// A set of voxels of a LeafIndex, one bit each, ranked: every member has a position in the set's
/// order of VoxelIds.
class VoxelSet {
 public:
  VoxelSet() = default;
  explicit VoxelSet(size_t leafCount) : words_(leafCount * 8) {}

  bool contains(VoxelId id) const { return words_[id >> 6] >> bitOf(id) & 1; }
  void insert(VoxelId id) { words_[id >> 6] |= uint64_t(1) << bitOf(id); }
  void erase(VoxelId id) { words_[id >> 6] &= ~(uint64_t(1) << bitOf(id)); }
  /// Safe from several threads at a time.
  void insertAtomic(VoxelId id) {
    uint64_t* word = &words_[id >> 6];
    const uint64_t bit = uint64_t(1) << bitOf(id);
    if (!(__atomic_load_n(word, __ATOMIC_RELAXED) & bit))
      __atomic_fetch_or(word, bit, __ATOMIC_RELAXED);
  }
  uint64_t word(size_t i) const { return words_[i]; }  ///< voxels 64 i .. 64 i + 63
  uint64_t& word(size_t i) { return words_[i]; }
  size_t wordCount() const { return words_.size(); }

  /// Makes rank() and size() valid; call after the last change.
  void rankMembers();
  uint32_t size() const { return size_; }
  uint32_t rank(VoxelId id) const {
    return before_[id >> 6] + detail::countBits(words_[id >> 6] & ((uint64_t(1) << bitOf(id)) - 1));
  }
  /// Members in ascending order.
  std::vector<VoxelId> members() const;

 private:
  std::vector<uint64_t> words_;
  std::vector<uint32_t> before_;  // members in earlier words
  uint32_t size_ = 0;
};

}  // namespace vdb_madf
