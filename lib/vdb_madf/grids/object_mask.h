// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"

namespace vdb_madf {

/// The object X of a VDB grid, as the active voxels of a mask grid; tiles stay tiles.
///
/// Bool, Mask, Int32, Int64, Float and Double grids. Without a selection: of a level set
/// (GRID_LEVEL_SET) the voxels of negative value, the inactive interior included; of any other grid
/// the active voxels of positive value (Mask: all active voxels). With one: the active voxels whose
/// value it accepts; inverted, all other voxels of the domain (NaN excepted). Domain, voxel size,
/// transform and source are carried over. An empty grid gives an empty mask.
/// @throw InvalidInput for other grid types, or an inverted selection on a grid without a domain.
MaskGrid::Ptr objectMask(const openvdb::GridBase& grid,
                         const std::optional<Selection>& selection = std::nullopt);

/// The same voxels as a Bool grid with the mask's name, transform and metadata: what files hold, as
/// other programs do not read mask grids. Uniform 8x8x8 blocks become tiles.
BoolGrid::Ptr toBoolGrid(const MaskGrid& mask);

}  // namespace vdb_madf
