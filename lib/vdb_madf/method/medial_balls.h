// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/leaves/voxel_set.h"
#include "vdb_madf/method/power_map.h"

namespace vdb_madf {

/// The reduced discrete medial axis (Coeurjolly & Montanvert 2007): the sites that win a cell.
VoxelSet medialBalls(const LeafIndex& index, const PowerMap& map,
                     Interrupter* interrupter = nullptr);

/// Cells and radii of the medial balls, by rank.
struct MedialBallTable {
  std::vector<uint32_t> cellSize;      ///< voxels p with Pi(p) = ball
  std::vector<int32_t> squaredRadius;  ///< D(ball)
};
MedialBallTable measureBalls(const LeafIndex& index, const PowerMap& map, const VoxelSet& balls,
                             Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
