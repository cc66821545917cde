// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Adds to the tree the leaves of the slab that hold object. `slab`: at most one layer of leaves,
/// of which the tree has none yet; `samples`: one per voxel of it, x fastest.
void packMask(const void* samples, SampleType type, const CoordBBox& slab,
              const Selection& selection, MaskTree& tree);

}  // namespace vdb_madf::detail
