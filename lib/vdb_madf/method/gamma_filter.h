// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/leaves/voxel_set.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf {

/// The medial balls that survive the filter: those whose cell holds at least gamma voxels. A
/// 6-connected component of X where none does keeps its best one (largest D, then smaller
/// coordinate), so that a small loose piece stays a grain. Where all of a component belongs to
/// balls elsewhere, which happens across the unknown voxels of a region alone, it keeps the best of
/// these. gamma <= 1 keeps all.
VoxelSet keptBalls(const LeafIndex& index, const PowerMap& map, const VoxelSet& balls,
                   const MedialBallTable& table, int64_t gamma, Interrupter* interrupter = nullptr);

/// The power map of the kept balls (paper, section 5.1). Voxels that none of them covers are
/// completed geodesically (the paper takes the least power over all balls, also across a pore). In
/// synchronous rounds each takes the best, in the order of power_map.h, of its own site and those
/// of its six neighbors in X after the round before, until nothing changes.
/// The power of such voxels may be 0 or more.
/// @throw Interrupted
PowerMap filteredPowerMap(const LeafIndex& index, PowerMap unfiltered, const VoxelSet& balls,
                          const MedialBallTable& table, const VoxelSet& kept,
                          Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
