// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grid_types.h"

namespace vdb_madf {

/// A synthetic object in [0, size - 1], with its domain in the metadata. The same options give the
/// same bits on every machine and for any number of threads.
struct Sample {
  MaskGrid::Ptr object;
  Int32Grid::Ptr truth;  ///< labels 1..N of the true grains; null where there is no truth
};

/// Balls wholly inside the box, as in Table 1 (a) of the paper: real radii uniform in
/// [minRadius, maxRadius], integer centres, open balls |p - c| < r. overlap = (sum of ball volumes
/// 4/3 pi r^3 - |X|) / |X| is met within 1 % of its value; every ball owns at least one truth
/// voxel. truth = the power map of the input balls.
struct SphereOptions {
  Coord size{300, 300, 300};
  uint64_t seed = 1;
  int count = 100;
  double minRadius = 20, maxRadius = 30;
  double overlap = 0.084;
};
/// @throw InvalidInput if the overlap cannot be met.
Sample generateSpheres(const SphereOptions& options, Interrupter* interrupter = nullptr);

/// Balls of real radius uniform in [minRadius, maxRadius] at uniform real centres, Boolean union,
/// cropped at the faces, until the solid fraction is met within 0.5 % absolute. No truth. Works
/// leaf by leaf: no dense array at any size.
struct PackOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.25;
  double minRadius = 8, maxRadius = 28;
};
Sample generatePack(const PackOptions& options, Interrupter* interrupter = nullptr);

/// Isotropic Gaussian random field with peak wavelength `length` (voxels), cut to the ice fraction
/// (met within 0.5 % absolute). No truth.
struct SnowOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.3;
  double length = 40;
};
Sample generateSnow(const SnowOptions& options, Interrupter* interrupter = nullptr);

/// Sintered balls with known grains: centres uniform in the box, at least neck * (ri + rj) apart,
/// real radii uniform in [minRadius, maxRadius]; the indicator of the union, Gaussian-blurred
/// (sigma 2), plus roughness * 1.5 * (unit white noise blurred with sigma 1), cut at 0.45.
/// truth = power cell of the input balls.
struct SinteredOptions {
  Coord size{180, 180, 180};
  uint64_t seed = 1;
  int count = 90;
  double minRadius = 12, maxRadius = 22;
  double neck = 0.82;
  double roughness = 0;
};
/// @throw InvalidInput if so many balls cannot be placed.
Sample generateSintered(const SinteredOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
