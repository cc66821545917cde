// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

// This header is for programs that hand a mask in and want labels out. No header of OpenVDB comes
// with this one, so that a file that includes it compiles in a second; segmentation/segment.h has
// all options and results.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/base/voxel_size.h"

namespace vdb_madf {

/// The options of SegmentOptions that are set most often, with its defaults.
struct ArrayOptions {
  int64_t gamma = 0;                        ///< smallest cell of a medial ball, voxels
  double strictness = 11;                   ///< of joins; the larger, the more grains
  std::optional<VoxelSize> voxelSize = {};  ///< matters to labels if its edges differ
};

/// The grains of an array.
struct ArraySegmentation {
  std::vector<int32_t> labels;       ///< in the order of the mask: 1..N on the object, 0 elsewhere
  std::vector<int64_t> grainVoxels;  ///< voxels of grain g at g - 1: N of them
};

/// The grains of a dense volume, as segment() finds them.
/// @param mask  nx * ny * nz voxels, x fastest: (x, y, z) is at (z * ny + y) * nx + x; those that
///   are not 0 are the object. What lies beyond the faces is unknown, as for an image.
/// @param size  nx, ny, nz
/// An empty object gives labels of 0 and no grains. Memory: 4 bytes a voxel for the labels, and
/// what segment() needs (segment_memory.h).
/// @throw InvalidInput for a size below 1 or beyond what limits.h says, for an object that fills
/// the volume, and for the options; Interrupted.
ArraySegmentation segmentArray(const uint8_t* mask, const std::array<int64_t, 3>& size,
                               const ArrayOptions& options = {},
                               Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
