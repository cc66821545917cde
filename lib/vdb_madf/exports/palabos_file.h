// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Writes the grains over `box` as a geometry for Palabos, whole or not at all: a digit and a space
/// per voxel, x slowest, a line per row along z, without a header. 0: fluid, no grain is there;
/// 1: wall, where fluid bounces back: of a grain, and a face of the box or one of the 26 neighbors
/// without a grain is next to it; 2: inside of grains, nothing is computed there. What lies outside
/// of the labels' region is as a grain.
///
/// Memory: ten slices across x, a byte a voxel, and a mask of the grains.
/// @throw InvalidInput if the box is empty; IoError; Interrupted.
void writePalabos(const std::string& path, const Int32Grid& labels, const CoordBBox& box,
                  Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
