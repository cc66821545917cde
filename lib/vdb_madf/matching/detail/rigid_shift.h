// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Voxels of a set by leaves, ascending by origin.
using VoxelSetByLeaves = std::vector<LeafIndex::LeafVoxels>;

/// The labeled voxels. @throw InvalidInput as LeafIndex does
VoxelSetByLeaves labelledVoxels(const Int32Grid& labels);

/// Voxels p of `before` with p + shift in `after`. @throw Interrupted
int64_t commonVoxels(const VoxelSetByLeaves& before, const VoxelSetByLeaves& after,
                     const Coord& shift, Interrupter* interrupter);

/// The shift of whole voxels, at most `most` along each axis, that brings most voxels of `before`
/// to voxels of `after`; of several the shortest, then the first in lexicographic order.
///
/// Where `most` exceeds 3 it is looked for in sets of half the size first, over and over until
/// there it does not, in which a voxel stands for 2 x 2 x 2 of which at least four (or two, or one,
/// if else too little is left) are in the set. The best few there are refined, and at last the best
/// one until none of its 26 neighbors is better: the best of all, if the finer detail does not
/// belie the coarser.
/// @throw Interrupted
Coord findShift(const VoxelSetByLeaves& before, const VoxelSetByLeaves& after, int most,
                Interrupter* interrupter);

}  // namespace vdb_madf::detail
