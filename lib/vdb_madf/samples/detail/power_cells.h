// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/samples/detail/ball_union.h"

namespace vdb_madf::detail {

/// Gives each voxel p of the object the ball of least power |p - c|^2 - r^2 (tie: the earlier
/// ball), in the object's topology. The balls that own a voxel are numbered 1..N in their order.
/// The object must have no active tiles.
/// @throw Interrupted
Int32Tree::Ptr powerCells(const MaskTree& object, const std::vector<Ball>& balls,
                          Interrupter* interrupter, const Lattice& lattice = {});

}  // namespace vdb_madf::detail
