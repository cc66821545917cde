// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Writes the labels over `box` as a VTK image, whole or not at all: Int32 cell data `grain_id`
/// (background 0) and UInt8 `color` (grainColors(), background black), x fastest, appended raw.
///
/// Cell (i,j,k) is voxel (i,j,k), extents are those of the box: a cell's center lies at the world
/// position of its voxel, so the origin, a corner of cells, lies half a voxel below that of
/// (0,0,0). Memory: eight slices; compressed (zlib): the compressed file and eight slices per
/// thread.
/// @throw InvalidInput if the voxels are not boxes along the axes or the box is empty; IoError;
///   Interrupted.
void writeVti(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
              bool compressed = false, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
