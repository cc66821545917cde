// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/picture.h"

namespace vdb_madf {

/// The slices through the middle of a box, in one scale and in true proportions.
struct LabelSlices {
  /// x-y (x to the right, y down, as image viewers show it), x-z and y-z (z up).
  std::array<Picture, 3> pictures;
  /// Shortest edges of a voxel in a pixel: 1 / (a whole number of pixels), or a whole number: of
  /// cubes, every so manieth is shown.
  double voxelsPerPixel = 1;
};

/// The grains that the middle slices of `box` cut, each in its colour on a dark background. The
/// scale is such that the longest axis of the box has about `edge` pixels, never more.
/// @param box not empty
/// @throw InvalidInput if the box is empty or `edge` is less than 1.
LabelSlices middleSlices(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                         int edge = 512);

}  // namespace vdb_madf
