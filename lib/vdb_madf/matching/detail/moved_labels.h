// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The labels of voxels p at p + shift, as far as that lies in a box; without metadata and tiles.
/// @throw Interrupted
Int32Grid::Ptr movedLabels(const Int32Grid& labels, const Coord& shift, const CoordBBox& within,
                           Interrupter* interrupter);

}  // namespace vdb_madf::detail
