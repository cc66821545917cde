// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/leaves/detail/leaf_layers.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Counts pairs of object voxels along an axis, leaf by leaf in pencils. The index must live as
/// long.
class VoxelPairs {
 public:
  /// The first voxel of a pair lies in some layers of leaves.
  VoxelPairs(const LeafIndex& index, int axis, const LeafLayers& layers = {});

  /// Counts the pairs that lie `lag` apart; it is fastest in rising order. @throw Interrupted
  int64_t count(int lag, Interrupter* interrupter);

  /// A leaf, and the two that lie across it once it is shifted along its pencil; null: none.
  struct Across {
    const uint64_t *own, *near, *far;
  };

 private:
  Across across(size_t i, int shift) const;

  const LeafIndex* index_;
  int axis_;
  LeafLayers layers_;
  std::vector<uint32_t> order_;
  std::vector<Across> across_;  // leaf pairs for the current shift, in that order
  int leavesApart_ = -1;        // the current shift, in leaves; -1: none
};

}  // namespace vdb_madf::detail
