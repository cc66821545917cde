// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Adds to the tree the leaves of the slab that hold a label: active where it is not 0. `slab`: at
/// most one layer of leaves, of which the tree has none yet; `samples`: one per voxel of it, x
/// fastest.
/// @throw InvalidInput that begins with `name` if a value is no integer or beyond int32.
void packLabels(const std::string& name, const void* samples, SampleType type,
                const CoordBBox& slab, Int32Tree& tree);

}  // namespace vdb_madf::detail
