// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/segmentation/segment.h"

namespace vdb_madf {

/// The medial balls of a segmentation as a file keeps them: two grids with the transform and the
/// metadata of the labels, whose active voxels are the balls' centers. "balls" holds the squared
/// radius (D); "balls_cell_size" how many voxels map to the ball.
std::vector<Int32Grid::Ptr> ballGrids(const Segmentation& segmentation);

/// The squared radii of the medial balls of an object with air around it, so that none reaches
/// beyond the scan.
/// @param maxMemory bytes, as in SegmentOptions
/// @throw as segment()
Int32Grid::Ptr closedBalls(const MaskGrid& object, int64_t maxMemory,
                           Interrupter* interrupter = nullptr);

/// The squared radii among the grids of a file, "balls"; null if they were not kept.
Int32Grid::Ptr storedBalls(const std::vector<openvdb::GridBase::Ptr>& grids);

/// False if balls are those of more or fewer voxels than these labels have, as after grains were
/// dropped: their counts tell.
bool areBallsOfObject(const Int32Grid& balls, const Int32Grid& labels);

}  // namespace vdb_madf
