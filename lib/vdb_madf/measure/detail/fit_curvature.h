// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/detail/voxel_shape.h"
#include "vdb_madf/measure/interface_curvature.h"

namespace vdb_madf::detail {

/// A voxel face that two grains share: between voxel `lower` and the next one along the axis. Its
/// point is its center.
struct InterfaceFace {
  Coord lower;
  int8_t axis = 0;
  int8_t sign = 1;  ///< 1: the first grain of the bond is on the lower side, else -1
};

/// Fits a surface, height over the local tangent plane, to the faces within 5 voxels of a point
/// along that plane (and 5.5 in space; of unequal voxels the edges of a cube of equal volume),
/// weighted by their areas, and takes its curvatures at the point. Of a large interface 32 points
/// are taken, evenly in the order of the faces. The mean curvature is positive where the first
/// grain is convex: 1/r if it is a ball of radius r within the second.
///
/// A polynomial of degree 2 (Cazals & Pouget 2005) bends a ball of radius r too much by 25 / (4
/// r^2), 17 % at 6 voxels: a ball is deeper than its paraboloid. So with p the place in the plane
/// and S the second derivatives of the height at the point, the surface is
///   h(p) = c0 + c1 p + p S p / (1 + sqrt(1 - |S p|^2)),
/// which is the ball or cylinder itself where S is that of one, and for any S agrees to degree 3
/// with the paraboloid. |S p|^2 comes from the fit before, beginning with 0, and is 3/4 at most.
/// \p faces ascending in x of `lower`. None if no point can be fitted: fewer than 10 faces, or all
/// in a row.
std::optional<InterfaceCurvature> fitCurvature(const std::vector<InterfaceFace>& faces,
                                               const VoxelShape& voxel = {});

}  // namespace vdb_madf::detail
