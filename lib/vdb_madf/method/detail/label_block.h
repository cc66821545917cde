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
            const std::array<uint32_t, 27>& around) {
    loadFaces(index, labels, around);
    loadEdges(index, labels, around);
  }
  /// The leaf and what lies beside its faces; then what lies beside its edges and corners alone.
  void loadFaces(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                 const std::array<uint32_t, 27>& around);
  void loadEdges(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                 const std::array<uint32_t, 27>& around);

  uint32_t at(uint32_t offset) const {
    return label[(offset >> 6) + 1][(offset >> 3 & 7) + 1][(offset & 7) + 1];
  }

  /// The voxels of the leaf that have a face neighbor of another label. Needs no edges.
  LeafIndex::Mask interfaces() const;

  struct Change {
    uint32_t offset, label;
  };
  /// The voxels, of some, to which a round of smoothing (tidy.h) gives another label; ascending. Returns
  /// their number. \p changes: of 512.
  size_t smooth(const LeafIndex::Mask& voxels, Change* changes) const;
};

}  // namespace vdb_madf::detail
