// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A synthetic object in [0, size - 1], with its domain in the metadata, and in `madf_source` the
/// command that makes it. The same options give the same bits on every machine and for any number
/// of threads. Lengths are in voxels; size is 1 to 26754 along each axis, radii are 0.5 or more.
///
/// Each generator @throw InvalidInput for options out of range, or that cannot be met; Interrupted.
struct Sample {
  MaskGrid::Ptr object;  ///< named `object`
  /// Named `truth`, the object's topology: labels 1..N of the true grains, numbered by the centres
  /// of their balls (x, then y, then z). Null where there is no truth.
  Int32Grid::Ptr truth;
};

/// Balls wholly inside the box, as in Table 1 (a) of the paper: real radii uniform in
/// [minRadius, maxRadius], integer centres, open balls |p - c| < r. overlap = (sum of ball volumes
/// 4/3 pi r^3 - |X|) / |X| is met within 1 % of its value (0: no two balls share a voxel).
/// truth = the power map of the input balls.
///
/// Centres are uniform over all placements that have this overlap and where
/// - each ball has the least power at its own centre, |ci - cj|^2 > |ri^2 - rj^2|: then it owns a
///   voxel, and is a critical point of the power map of the balls; a ball that a larger one nearly
///   swallows is no grain;
/// - no voxel lies in more than maxCover balls. Where three or more meet in one place, their union
///   may be widest between their centres: it then has more grains than balls, by any measure of
///   width. By default balls meet in pairs only; 0 asks for nothing.
/// (A Markov chain finds a placement: moves of single balls, first towards the overlap, then 100
/// for each ball at that overlap.)
struct SphereOptions {
  Coord size{300, 300, 300};
  uint64_t seed = 1;
  int count = 100;
  double minRadius = 20, maxRadius = 30;
  double overlap = 0.084;  ///< 0..100
  int maxCover = 2;        ///< 0: any; else 1 or more
};
Sample generateSpheres(const SphereOptions& options, Interrupter* interrupter = nullptr);

/// Balls of real radius uniform in [minRadius, maxRadius] at uniform real centres, Boolean union,
/// cropped at the faces, until the solid fraction is met within 0.5 % absolute. No truth. Centres
/// lie in the box grown by maxRadius, so that the faces see as many balls as the middle; at the
/// end, a ball that would exceed the fraction is left out. Works leaf by leaf: no dense array at
/// any size; full leaves are active tiles.
struct PackOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.25;  ///< above 0, below 1
  double minRadius = 8, maxRadius = 28;
};
Sample generatePack(const PackOptions& options, Interrupter* interrupter = nullptr);

/// Isotropic Gaussian random field with peak wavelength `length` (voxels), cut to the ice fraction
/// (met within 0.5 % absolute). No truth. The spectral density is k^4 exp(-2 k^2 / k0^2) with k0 =
/// 2 pi / length, the same up to the faces; full leaves are active tiles. Memory: dense floats on
/// every n-th voxel along each axis, n about length / 11, and on length around the box.
struct SnowOptions {
  Coord size{256, 256, 256};
  uint64_t seed = 1;
  double fraction = 0.3;  ///< above 0, below 1
  double length = 40;     ///< 4 or more
};
Sample generateSnow(const SnowOptions& options, Interrupter* interrupter = nullptr);

/// Sintered balls with known grains: centres uniform in the box, at least neck * (ri + rj) apart,
/// real radii uniform in [minRadius, maxRadius]; the indicator of the union, Gaussian-blurred
/// (sigma 2), plus roughness * 1.5 * (unit white noise blurred with sigma 1), cut at 0.45.
/// truth = power cell of the input balls. Each ball keeps its radius and tries up to 50000 centres;
/// balls continue beyond the faces, so that the blur rounds nothing off there. A ball that owns no
/// ice voxel is no grain. Works in blocks of 128^3: no dense array over the box.
struct SinteredOptions {
  Coord size{180, 180, 180};
  uint64_t seed = 1;
  int count = 90;
  double minRadius = 12, maxRadius = 22;
  double neck = 0.82;    ///< 0..10
  double roughness = 0;  ///< 0..10; 1: the noise has 0.22 standard deviation
};
Sample generateSintered(const SinteredOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
