// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// @throw InvalidInput that begins with `name` unless the grid holds one number a voxel.
void requireNumbers(const std::string& name, const openvdb::GridBase& grid);

/// The grid's values over the box (background outside its tiles and leaves) as samples, slab by
/// slab in ascending order: f(z, count, samples), x fastest. Grids that requireNumbers() accepts.
/// @throw InvalidInput that begins with `name` if a value does not fit the type; Interrupted.
void forEachSampleSlab(const std::string& name, const openvdb::GridBase& grid, const CoordBBox& box,
                       SampleType type, Interrupter* interrupter,
                       const std::function<void(int z, int count, const void* samples)>& f);

}  // namespace vdb_madf::detail
