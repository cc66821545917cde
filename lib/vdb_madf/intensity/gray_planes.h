// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/slice_plane.h"
#include "vdb_madf/intensity/gray_scan.h"

namespace vdb_madf {

/// What planes of a box show of a scan, all with one contrast: of the finite values of all planes,
/// the darkest 0.5 % are black (0), the brightest 0.5 % white (255); what is not finite is black.
/// Memory: eight slices of the scan, and four bytes a voxel of the planes.
/// @param box where placeScan() puts the scan
/// @param planes within the box
/// @throw InvalidInput, one line that names the scan, if its box does not hold the box; IoError;
///   Interrupted.
std::vector<GrayPlane> readGrayPlanes(GrayScan& scan, const CoordBBox& box,
                                      const std::vector<SlicePlane>& planes,
                                      Interrupter* interrupter = nullptr);

/// What blocks show of a scan, x fastest, then y, then z, with the same contrast of all blocks.
/// Block (i,j,k) has the voxels factor * i .. factor * i + factor - 1 along each axis, as in
/// reduceLabels(), and shows the mean of the finite values among them; without any it is black.
/// Memory: eight slices of the scan, and eight bytes a block.
/// @param factor 1 .. 256
/// @throw IoError; Interrupted.
std::vector<uint8_t> readGrayBlocks(GrayScan& scan, const CoordBBox& blocks, int factor,
                                    Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
