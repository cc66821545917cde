// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace vdb_madf {

/// A grain of fewer voxels is dust.
constexpr int64_t kDustVoxels = 100;

/// How the sizes of grains are distributed: by volume, so that dust does not hide the grains.
struct GrainSizes {
  int64_t dustGrains = 0;
  int64_t dustVoxels = 0;  ///< in them
  /// Diameters of the balls of the grains' volumes, voxels: grains up to this one hold at least 10,
  /// 50 and 90 % of all voxels. NaN without grains.
  double d10 = std::numeric_limits<double>::quiet_NaN(), d50 = d10, d90 = d10;
};

/// @param grainVoxels voxels of each grain, in any order, as in Segmentation::grainVoxels
GrainSizes grainSizes(std::vector<int64_t> grainVoxels);

}  // namespace vdb_madf
