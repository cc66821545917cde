// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// A number for each voxel of a leaf, 0 to 27, by binary digits: that of weight 2^i at bit[i].
using LeafCounts = std::array<LeafIndex::Mask, 5>;

/// What a set of voxels has around each voxel of a leaf.
struct VoxelsAround {
  LeafCounts count;       ///< in the 3 x 3 x 3 cube around the voxel, itself included
  LeafIndex::Mask faces;  ///< has one or more across a face
};

/// \p set: its masks in the 27 leaves around, in the order of LeafNeighborhood; no null pointers.
/// Counts 64 voxels at a time, by adding binary digits.
VoxelsAround voxelsAround(const std::array<const LeafIndex::Mask*, 27>& set);

/// Where a > b.
LeafIndex::Mask isGreater(const LeafCounts& a, const LeafCounts& b);

/// Sets a = b where \p voxels tell.
void assignCounts(LeafCounts& a, const LeafCounts& b, const LeafIndex::Mask& voxels);

/// The voxels with all 27 in the set.
LeafIndex::Mask areSurrounded(const VoxelsAround& around);

}  // namespace vdb_madf::detail
