// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A Bool grid of every label, named `grain_000123`, ascending: true and active on the grain's
/// voxels (active, tiles included, > 0), false elsewhere. Transform, domain and voxel size are the
/// labels'. An empty grid has none.
/// @throw InvalidInput if there are more than kMaxGrainGrids labels (grain_name.h) or a limit of
///   leaf_index.h is exceeded; Interrupted.
std::vector<BoolGrid::Ptr> grainMasks(const Int32Grid& labels, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
