// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf::detail {

/// The voxels of each label, leaf by leaf: most leaves have one or two labels, and what is asked of
/// 64 voxels at a time costs little.
class LabelMasks {
 public:
  struct Entry {
    LeafIndex::Mask mask;
    uint32_t label;
  };

  /// Label 0 has no entry. @throw Interrupted
  LabelMasks(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
             Interrupter* interrupter = nullptr);

  /// The entries of a leaf, by rising label. A label that lost its voxels may still have one.
  const Entry* begin(size_t leaf) const {
    return chunks_[leaf / kChunk].data() + lists_[leaf].first;
  }
  const Entry* end(size_t leaf) const { return begin(leaf) + lists_[leaf].count; }

  /// Leaves of one chunk, k kChunk .. (k + 1) kChunk - 1, are kept together: changes to different
  /// chunks may be made at a time.
  static constexpr size_t kChunk = 128;

  /// Gives voxels of a leaf to a label, instead of those that they have.
  void give(size_t leaf, uint32_t label, const LeafIndex::Mask& voxels);

 private:
  struct List {
    uint32_t first, count, capacity;
  };
  std::vector<std::vector<Entry>> chunks_;
  std::vector<List> lists_;  // per leaf
};

}  // namespace vdb_madf::detail
