// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Gives each voxel of the object the label there, or else that of the nearest labeled voxel within
/// `reach` (tie: the smaller); voxels without any are inactive. Labels are numbered anew where some
/// have vanished. The object must have no active tiles. @throw Interrupted
Int32Tree::Ptr carriedLabels(const Int32Tree& labels, const MaskTree& object, int reach,
                             Interrupter* interrupter);

}  // namespace vdb_madf::detail
