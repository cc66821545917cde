// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/pictures/picture.h"

namespace vdb_madf {

/// Where a view looks from, and how large it is.
struct ViewOptions {
  double azimuth = 35;    ///< degrees: 0 looks along +y with x to the right; 90: along -x
  double elevation = 25;  ///< degrees above the x-y plane, -90..90; z is up
  int edge = 512;         ///< pixels along the longer side, 1..16384
  Rgb background{255, 255, 255};
  bool surfaces = false;  ///< smoothed ones in the place of voxels that are three pixels wide
  Rgb ink{70, 74, 80};    ///< of names of axes
  bool turns = false;     ///< one scale and size for all azimuths
  bool box = false;  ///< also the edges of the box behind the grains and, around it, names of axes
};

/// A view, and which grain is seen where.
struct GrainView {
  Picture picture;
  std::vector<int32_t> labels;  ///< of each pixel, in the picture's order; 0: background
  double voxelsPerPixel = 0;    ///< shortest edges of a voxel, in the plane of the picture
};

/// A shaded view of colored grains from outside, in parallel projection: what lies in the box, cut
/// off at its faces.
///
/// A ray through the center of each pixel walks through the leaves, then through the voxels of a
/// leaf (Amanatides & Woo 1987), to the first voxel (a box in true proportions) that has a label.
/// Where a grain or a surface ends, a pixel is the mean of 3 x 3 rays. Normal: the gradient of the
/// object's indicator, smoothed over 4 voxels, near the surface where that is 1/2. Light: ambient,
/// less in concave places, and diffuse from above on the left; what is farther is a little darker.
/// With `surfaces`, where a voxel is three pixels wide or more, the smoothed surfaces of the grains
/// (grainMesh()) are drawn instead, from 3 x 3 samples a pixel: of the leaf nodes that the rays
/// meet, and of those around them. The light is as before.
/// The result does not depend on threads. An empty box gives a picture of one background pixel.
/// @throw InvalidInput for an option out of range; Interrupted.
GrainView viewGrains(const Int32Grid& labels, const CoordBBox& box, const GrainColors& colors,
                     const ViewOptions& options = {}, Interrupter* interrupter = nullptr);

// What follows is for labels that do not fit in memory together while the object they cover does.

/// The origins of the leaf nodes whose labels may be seen, ascending. Cuts the object, which has
/// the transform of the labels, to the box.
/// @throw as viewGrains()
std::vector<Coord> seenLeaves(const MaskGrid::Ptr& object, const CoordBBox& box,
                              const ViewOptions& options = {}, Interrupter* interrupter = nullptr);
/// \p seen: the labels of those leaf nodes at least.
GrainView viewGrains(const MaskGrid::Ptr& object, const Int32Grid& seen, const CoordBBox& box,
                     const GrainColors& colors, const ViewOptions& options = {},
                     Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
