// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The indicator of an object, smoothed: each voxel counts by its distance from a point along each
/// axis, (1 + cos(pi d / 4)) / 8 within 4 voxels. (Standard deviation: 1.45 voxels.) It has a
/// continuous gradient, so that light on it shows no steps of voxels.
struct SmoothValue {
  double fill = 0;             ///< 0..1; 1/2 on a plane
  openvdb::Vec3d gradient{0};  ///< per voxel, into the object
};

/// @param object without tiles
/// @param point in voxels; voxel (i, j, k) is the box from there to (i + 1, j + 1, k + 1)
SmoothValue smoothValue(const MaskGrid::ConstAccessor& object, const openvdb::Vec3d& point);

}  // namespace vdb_madf::detail
