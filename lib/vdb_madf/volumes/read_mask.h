// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Reads the image slab by slab and keeps one bit per voxel of the leaves that hold object. The
/// mask carries domain and source metadata, voxel size and transform. Peak memory: the mask and one
/// slab of eight slices.
MaskGrid::Ptr readMask(ImageReader& image, const Selection& selection = {},
                       Interrupter* interrupter = nullptr);

/// Several such masks in one pass.
/// @param box a part of the image's: what lies outside is not read, or left out
std::vector<MaskGrid::Ptr> readMasks(ImageReader& image, const std::vector<Selection>& selections,
                                     Interrupter* interrupter = nullptr,
                                     const std::optional<CoordBBox>& box = std::nullopt);

}  // namespace vdb_madf
