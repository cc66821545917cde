// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <optional>
#include <string>

#include "vdb_madf/grids/domain.h"

namespace vdb_madf {

/// A voxel lies in it if its center is at most `radius` from the axis: du^2 + dv^2 <= radius^2, in
/// double precision. It has no ends.
struct Cylinder {
  int axis = 2;  ///< 0: x, 1: y, 2: z
  std::array<double, 2> center{
      {0, 0}};        ///< voxels; the two other coordinates, in the order x, y, z
  double radius = 0;  ///< voxels
};

/// A cylinder of which not all is said. The center is then the middle of the scan's box. The radius
/// is fitted to the field of view: the least one, rounded up to hundredths, that holds all voxels
/// of other values than 0, but at most the largest that lies in the box. (Of an image whose eight
/// corners have one value, all voxels of other values than that; NaN never counts. Of a VDB grid,
/// the object that it has without a selection.) Where neither is said of a gray image, the center
/// is fitted, too, to hundredths: that of the smallest circle which holds the field of view, unless
/// it is larger than any in the box.
struct CylinderOptions {
  int axis = 2;
  std::optional<std::array<double, 2>> center;
  std::optional<double> radius;
};

/// The part of a scan to work on: what lies in all that are given. Outside of it nothing is known.
struct RegionOptions {
  /// A volume, any readable file that describes itself: voxels that are not 0 are inside (of a VDB
  /// those of its object), at the same coordinates as in the scan. Empty: none.
  std::string mask;
  MaskGrid::ConstPtr grid;  ///< instead of a file: its active voxels are inside
  std::optional<CylinderOptions> cylinder;
  std::optional<CoordBBox> crop;
  bool any() const { return !mask.empty() || grid || cylinder || crop; }
};

/// The voxels of the box that lie in the cylinder.
/// @throw InvalidInput if there are none.
Domain cylinderIn(const CoordBBox& box, const Cylinder& cylinder);

/// The radius up to which a cylinder around an axis lies in a box, whose faces are those of its
/// voxels. Not above 0 if the axis lies outside.
double largestRadius(const CoordBBox& box, int axis, const std::array<double, 2>& center);

}  // namespace vdb_madf
