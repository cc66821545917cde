// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/images/image.h"
#include "vdb_madf/scans/detail/cylinder_axis.h"

namespace vdb_madf::detail {

/// The squared distance from the axis of the farthest voxel of a field of view: of an image those
/// that are not 0, or not what all its eight corners are (NaN never is one), of a tree the active
/// ones. Below 0 if there is none.
double farthestFromAxis(ImageReader& image, const CylinderAxis& axis, Interrupter* interrupter);
double farthestFromAxis(const MaskTree& tree, const CylinderAxis& axis);

}  // namespace vdb_madf::detail
