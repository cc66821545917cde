// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

// The first part of tidy() in a slab: smoothing, which looks one voxel further each round.

namespace vdb_madf::detail {

/// The labels of some layers of leaves of a slab.
struct LeafLabels {
  std::vector<LeafIndex::LeafVoxels> leaves;  ///< ascending by origin
  std::vector<uint32_t> labels;               ///< voxel after voxel

  template <typename Self>
  static auto storedFields(Self& self) {
    return std::tie(self.leaves, self.labels);
  }
};

/// The labels of the leaves with begin <= z < end.
LeafLabels labelsBetween(const LeafIndex& index, const VoxelArray<uint32_t>& labels, int begin,
                         int end);

/// A slab with what lies beyond its cuts.
struct LabelWindow {
  LeafIndex index;
  VoxelArray<uint32_t> labels;
  std::vector<uint32_t> ownLeaves;  ///< those of the slab
};
LabelWindow labelWindow(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                        const LeafLabels& below, const LeafLabels& above);

/// The voxels that must not change, of grain g at g - 1.
using Anchors = std::vector<Coord>;

/// Smooths the labels of a slab. \p below and \p above: the merged labels beyond its cuts, as far
/// away as there are rounds.
void smoothSlab(const LeafIndex& index, const LeafLabels& below, const LeafLabels& above,
                const Anchors& anchors, int rounds, VoxelArray<uint32_t>& labels,
                Interrupter* interrupter);

}  // namespace vdb_madf::detail
