// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

// Grids of other voxels, cubes or not, in cubes of a given edge. The box of the grid is its
// domain's; where that is unknown, of its active voxels. Its corner stays where it is in the world:
// there cube (0,0,0) begins. Along each axis there are as many cubes as come nearest to the box's
// length (half a cube: one more). Of a domain that is no box, the cubes of which at least half lies
// in it are inside. Name, source, boundary and what is known of the object are carried over, and
// the transform says where the cubes lie; the method's own metadata are not.
//
// Volumes are exact integers: the edges of voxels and cubes are taken as multiples of a common
// length (cubes_along.h). The same for any number of threads. Memory: the result, and 16 bytes for
// each pair of a leaf node of it and one of the grid that overlap.
//
// @throw InvalidInput if the size of the voxels is unknown, cubes are beyond 256 times as long or
//   short, nothing would be left of the box or the region, the result would be too large, or the
//   grid leaves its domain; Interrupted.

/// A cube is object if at least half of its volume is.
/// @param edge of the cubes, meters, > 0
MaskGrid::Ptr resampleMask(const MaskGrid& mask, double edge, Interrupter* interrupter = nullptr);

/// A cube takes the label of the voxel whose center is nearest to its own (tie: along each axis the
/// lower one), or none if that has none or the cube lies outside of the domain. Labels are the
/// active voxels (tiles included) of positive value.
Int32Grid::Ptr resampleLabels(const Int32Grid& labels, double edge,
                              Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
