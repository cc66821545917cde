// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf::detail {

/// The labels of a leaf and of the layer of voxels around it; 0 where there is none.
struct LabelBlock {
  uint32_t label[10][10][10];  ///< voxel (x, y, z) of the leaf at [x + 1][y + 1][z + 1]

  /// \p around: the 27 leaves, as LeafNeighborhood tells them.
  void load(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
            const std::array<uint32_t, 27>& around);

  uint32_t at(uint32_t offset) const {
    return label[(offset >> 6) + 1][(offset >> 3 & 7) + 1][(offset & 7) + 1];
  }

  /// The voxels of the leaf that have a face neighbor of another label.
  LeafIndex::Mask interfaces() const;

  /// The label that tidy() gives to a voxel, in a round of smoothing.
  uint32_t majority(uint32_t offset) const;
};

}  // namespace vdb_madf::detail
