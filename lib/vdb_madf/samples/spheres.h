// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// Balls wholly inside the box, as in Table 1 (a) of the paper: real radii uniform in
/// [minRadius, maxRadius], integer centers, open balls |p - c| < r. overlap = (sum of ball volumes
/// 4/3 pi r^3 - |X|) / |X| is met within 1 % of its value (0: no two balls share a voxel). truth =
/// the power map of the input balls.
///
/// Centers are uniform over all placements that have this overlap and where
/// - each ball has the least power at its own center, |ci - cj|^2 > |ri^2 - rj^2|: then it owns a
///   voxel, and is a critical point of the power map of the balls; a ball that a larger one nearly
///   swallows is no grain;
/// - no voxel lies in more than maxCover balls. Where three or more meet in one place, their union
///   may be widest between their centers: it then has more grains than balls, by any measure of
///   width. By default balls meet in pairs only; 0 asks for nothing.
/// (A Markov chain finds a placement: moves of single balls, first towards the overlap, then 100
/// for each ball at that overlap.) Of voxels that are no cubes all this, the overlap
/// included, holds on the cubes of their shortest edge.
struct SphereOptions {
  Coord size{300, 300, 300};
  uint64_t seed = 1;
  int count = 100;
  double minRadius = 20, maxRadius = 30;
  double overlap = 0.084;              ///< 0..100
  int maxCover = 2;                    ///< 0: any; else 1 or more
  std::optional<VoxelSize> voxelSize;  ///< need not be cubes: see sample.h
};
Sample generateSpheres(const SphereOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
