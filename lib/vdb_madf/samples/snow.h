// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Isotropic Gaussian random field with peak wavelength `length` (voxels), cut to the ice fraction
/// (met within 0.5 % absolute). No truth. The spectral density is k^4 exp(-2 k^2 / k0^2), with
/// k0 = 2 pi / length, the same up to the faces; full leaves are active tiles. Memory: dense floats
/// on every n-th voxel along each axis, n about length / 11, and on length around the box.
struct SnowOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.3;  ///< above 0, below 1
  double length = 40;     ///< 4 or more
};
Sample generateSnow(const SnowOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
