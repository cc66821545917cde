// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/selection.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// How the voxels of a box lie in an array of the caller, whose pointer is that of the box's lower
/// corner. Neither side copies the array: it is read and written slab by slab.
struct DenseLayout {
  SampleType type = SampleType::uint8;
  CoordBBox box;  ///< the domain; not empty, |coordinates| <= kMaxCoordinate
  /// Samples from a voxel to its neighbor along x, y and z. Absent: x fastest, without gaps, which
  /// is an array [z, y, x] in the order of C; [x, y, z] in that order is {ny nz, nz, 1}.
  std::optional<std::array<int64_t, 3>> strides;
};

/// The object of a dense array, as readMask() makes it of an image.
/// @throw InvalidInput if the box is empty or too far out; Interrupted.
MaskGrid::Ptr maskFromDense(const void* samples, const DenseLayout& layout,
                            const Selection& selection = {},
                            const std::optional<VoxelSize>& voxelSize = std::nullopt,
                            Interrupter* interrupter = nullptr);

/// The labels of a dense array, as readLabels() makes them of an image.
/// @throw InvalidInput if a value is no integer or beyond int32, or for the box; Interrupted.
Int32Grid::Ptr labelsFromDense(const void* samples, const DenseLayout& layout,
                               const std::optional<VoxelSize>& voxelSize = std::nullopt,
                               Interrupter* interrupter = nullptr);

/// The grid's values over the box, as writeImage() writes them; a mask's are 0 and 1. What lies
/// between strides is left alone; after an error the array is written in part.
/// @throw InvalidInput for a grid without numbers, a value that does not fit the type, or the box;
/// Interrupted.
void copyToDense(const openvdb::GridBase& grid, void* samples, const DenseLayout& layout,
                 Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
