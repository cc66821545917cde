// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
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

/// A function that is given the masks with what was read last besides what it left in them: a layer
/// of leaf nodes, from the lowest on, not yet cut to the box. What it takes out need not fit in
/// memory.
using LayerRead = std::function<void(const std::vector<MaskGrid::Ptr>& masks)>;

/// Reads several such masks in one pass.
/// @param box a part of the image's: what lies outside is not read, or left out
std::vector<MaskGrid::Ptr> readMasks(ImageReader& image, const std::vector<Selection>& selections,
                                     Interrupter* interrupter = nullptr,
                                     const std::optional<CoordBBox>& box = std::nullopt,
                                     const LayerRead& layerRead = nullptr);

}  // namespace vdb_madf
