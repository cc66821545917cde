// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <memory>

#include "vdb_madf/images/image.h"

namespace vdb_madf {

/// A gray image of other voxels in cubes of a given edge, while it is read: values are interpolated
/// linearly between the centers of voxels, in double precision, along x last; beyond the outermost
/// centers the outermost values go on. The sample type stays: integers are rounded to the nearest
/// (half up). The corner of the image stays where it is; along each axis there are as many cubes as
/// come nearest to its length (half a cube: one more). It holds the two slices around a cube. The
/// same bits for any number of threads, and however it is read.
/// @param voxels their size, whatever the image says
/// @param edge of the cubes, meters, > 0
/// @throw InvalidInput if cubes are beyond 256 times as long or short, less than half of one is
///   needed, or the result would be too large
std::unique_ptr<ImageReader> resampledImage(std::unique_ptr<ImageReader> image,
                                            const VoxelSize& voxels, double edge);

/// The place of the center of the first cube of resampledImage(), if that of the first voxel is at
/// 0; mm.
std::array<double, 3> resampledOrigin(const VoxelSize& voxels, double edge);

}  // namespace vdb_madf
