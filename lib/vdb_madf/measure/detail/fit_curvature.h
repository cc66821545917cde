// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/interface_curvature.h"

namespace vdb_madf::detail {

/// A voxel face that two grains share: between voxel `lower` and the next one along the axis. Its
/// point is its centre.
struct InterfaceFace {
  Coord lower;
  int8_t axis = 0;
  int8_t sign = 1;  ///< 1: the first grain of the bond is on the lower side, else -1
};

/// Fits a polynomial of degree 2, height over the local tangent plane, to the faces within 5 voxels
/// of a point (Cazals & Pouget 2005), and takes the curvatures of that surface at the point. Of a
/// large interface 32 points are taken, evenly in the order of the faces. The mean curvature is
/// positive where the first grain is convex: 1/r if it is a ball of radius r within the second.
/// \p faces ascending in x of `lower`. None if no point can be fitted: fewer than 10 faces, or all
/// in a row.
std::optional<InterfaceCurvature> fitCurvature(const std::vector<InterfaceFace>& faces);

}  // namespace vdb_madf::detail
