// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Sintered balls with known grains: centers uniform in the box, at least neck * (ri + rj) apart,
/// real radii uniform in [minRadius, maxRadius]; the indicator of the union, Gaussian-blurred
/// (sigma 2), plus roughness * 1.5 * (unit white noise blurred with sigma 1), cut at 0.45.
/// Indicator and noise live on cubes; the Gaussians give their values at the centers of other
/// voxels. truth = power cell of the input balls. Each ball keeps its radius and tries up to 50000
/// centers; balls continue beyond the faces, so that the blur rounds nothing off there. A ball that
/// owns no object voxel is no grain. Works in blocks of 128^3: no dense array over the box.
struct SinteredOptions {
  Coord size{180, 180, 180};
  uint64_t seed = 1;
  int count = 90;
  double minRadius = 12, maxRadius = 22;
  double neck = 0.82;                  ///< 0..10
  double roughness = 0;                ///< 0..10; 1: the noise has 0.22 standard deviation
  std::optional<VoxelSize> voxelSize;  ///< need not be cubes: see sample.h
};
Sample generateSintered(const SinteredOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
