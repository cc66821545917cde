// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/detail/leaf_layers.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// The voxels of a leaf that have one label.
struct LabelPart {
  int32_t label = 0;
  LeafIndex::Mask mask{};
};

/// A label grid by leaves. Labeled are the active voxels, tiles included, of positive value.
class LabelLeaves {
 public:
  LabelLeaves(const Int32Grid& labels, Interrupter* interrupter);
  /// The leaves of several, which have none in common, that lie in some layers.
  LabelLeaves(const std::vector<const LabelLeaves*>& parts, const LeafLayers& layers);

  const LeafIndex& index() const { return index_; }

  /// A part for each label in a leaf, in the order of their first voxels.
  class Parts {
   public:
    Parts(const LabelPart* begin, const LabelPart* end) : begin_(begin), end_(end) {}
    const LabelPart* begin() const { return begin_; }
    const LabelPart* end() const { return end_; }
    size_t size() const { return size_t(end_ - begin_); }

   private:
    const LabelPart *begin_, *end_;
  };
  Parts parts(size_t leaf) const {
    const Chunk& chunk = chunks_[leaf / kChunk];
    const uint32_t* first = &chunk.first[leaf % kChunk];
    return {chunk.parts.data() + first[0], chunk.parts.data() + first[1]};
  }
  /// @pre the voxel is labeled
  int32_t label(size_t leaf, int offset) const;

 private:
  static constexpr size_t kChunk = 256;  // leaves
  struct Chunk {
    std::vector<LabelPart> parts;
    std::vector<uint32_t> first{0};  // of each leaf, and one more
  };

  LeafIndex index_;
  std::vector<Chunk> chunks_;
};

}  // namespace vdb_madf::detail
