// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Balls of real radius uniform in [minRadius, maxRadius] at uniform real centres, Boolean union,
/// cropped at the faces, until the solid fraction is met within 0.5 % absolute. No truth. Centres
/// lie in the box grown by maxRadius, so that the faces see as many balls as the middle; at the
/// end, a ball that would exceed the fraction is left out. Works leaf by leaf: no dense array at
/// any size; full leaves are active tiles. The fraction is that of the sample's own voxels: if these
/// are no cubes, the balls are not quite those of cubes.
struct PackOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.25;  ///< above 0, below 1
  double minRadius = 8, maxRadius = 28;
  /// Of voxels that need not be cubes: see sample.h.
  std::optional<VoxelSize> voxelSize;
};
Sample generatePack(const PackOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
