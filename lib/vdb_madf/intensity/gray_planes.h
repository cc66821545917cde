// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/slice_plane.h"
#include "vdb_madf/intensity/gray_scan.h"

namespace vdb_madf {

/// What planes of a box show of a scan, all with one contrast: of the finite values of all planes,
/// the darkest 0.5 % are black (0), the brightest 0.5 % white (255); what is not finite is black.
/// Memory: eight slices of the scan, and four bytes a voxel of the planes.
/// @param box within the scan's
/// @param planes within the box
/// @throw InvalidInput, one line that names the scan, if its box does not hold the box; IoError;
///   Interrupted.
std::vector<GrayPlane> readGrayPlanes(GrayScan& scan, const CoordBBox& box,
                                      const std::vector<SlicePlane>& planes,
                                      Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
