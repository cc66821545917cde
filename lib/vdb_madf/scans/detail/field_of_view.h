// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/images/image.h"
#include "vdb_madf/scans/detail/cylinder_axis.h"
#include "vdb_madf/scans/detail/enclosing_circle.h"

namespace vdb_madf::detail {

/// Points across an axis (in the order of CylinderAxis::u(), v()) that hold all others of a field
/// of view between them: the voxels of an image that are not 0, or not what all its eight corners
/// are (NaN never is one). None if it has no such voxel.
std::vector<PlanePoint> rimOfView(ImageReader& image, int axis, Interrupter* interrupter);

/// The squared distance from the axis of the farthest one; below 0 if there is none.
double farthestFromAxis(const std::vector<PlanePoint>& rim, const CylinderAxis& axis);
/// The squared distance from the axis of the farthest active voxel of a tree.
double farthestFromAxis(const MaskTree& tree, const CylinderAxis& axis);

}  // namespace vdb_madf::detail
