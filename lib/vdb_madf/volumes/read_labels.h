// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// Labels of an integer image, slab by slab: active where the value is not 0. Domain, voxel size
/// and source as readMask.
/// @param box a part of the image's: slices beyond it are not read; the others are read whole
/// @throw InvalidInput if a value is no integer or beyond int32; IoError; Interrupted.
Int32Grid::Ptr readLabels(ImageReader& image, Interrupter* interrupter = nullptr,
                          const std::optional<CoordBBox>& box = std::nullopt);

}  // namespace vdb_madf
