// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/slice_plane.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/picture.h"

namespace vdb_madf {

/// Which slices are drawn, and what of them.
struct SliceOptions {
  int edge = 512;                  ///< pixels of the longest axis of the box, 1 or more
  std::vector<SlicePlane> planes;  ///< none: middlePlanes()
  /// The grains, or parts of them, that have their color, under their labels; the others are pale.
  /// Null: all.
  const Int32Grid* shown = nullptr;
  /// What lies under each plane: the grains are then outlines of their color, with a dark and a
  /// light line. None: the grains are filled.
  std::vector<GrayPlane> gray;
};

/// Slices of a box, in one scale and in true proportions.
struct LabelSlices {
  std::vector<SlicePlane> planes;
  /// x-y (x to the right, y down, as image viewers show it), x-z and y-z (z up).
  std::vector<Picture> pictures;
  double voxelsPerPixel = 1;  ///< shortest edges of a voxel
};

/// Where z, y and x are in the middle, in this order.
std::vector<SlicePlane> middlePlanes(const CoordBBox& box);

/// The grains that planes cut, each in its color on a pale background. Pixels are means of 3 x 3
/// places (of 2 x 2 in outlines), so that nothing has steps.
/// @param box not empty
/// @throw InvalidInput if the box is empty, `edge` is less than 1, a plane misses the box or gray
///   values do not fit it; Interrupted.
LabelSlices labelSlices(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                        const SliceOptions& options = {}, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
