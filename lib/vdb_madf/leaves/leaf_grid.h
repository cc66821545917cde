// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

namespace vdb_madf {

/// An Int32 grid with the topology of X and the array's values; background 0, inactive elsewhere.
/// @throw Interrupted
Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<int32_t>& values,
                      const std::string& name, Interrupter* interrupter = nullptr);
/// Writes values[rank] & 0x7fffffff to each voxel.
Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<uint32_t>& values,
                      const std::string& name, Interrupter* interrupter = nullptr);
/// Writes the same grid; the array's memory goes back to the system while the grid grows.
Int32Grid::Ptr toGrid(const LeafIndex& index, VoxelArray<uint32_t>&& values,
                      const std::string& name, Interrupter* interrupter = nullptr);

/// Makes voxels of the index background, 0 and inactive; leaves without active voxels go. `voxels`
/// ascends.
void removeVoxels(Int32Grid& grid, const LeafIndex& index, const std::vector<VoxelId>& voxels);

}  // namespace vdb_madf
