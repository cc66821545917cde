// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/samples/sample.h"

namespace vdb_madf {

/// A bed of sintered balls with known grains, whose necks grow by curvature flow, not by overlap.
///
/// Balls of real radii, uniform in [minRadius, maxRadius], fall one after the other: each straight
/// down, onto the floor z = -1/2 or to 0.97 times the sum of the radii from the ball it meets, at
/// the one of 300 uniform places (x, y) where it comes to lie lowest. The first ball that would lie
/// wholly above the box ends this. Balls continue beyond the sides. Each voxel in a ball goes to
/// that of its power cell.
///
/// Then come rounds of sintering. The indicator is blurred (Gaussian of sigma 2, beyond the faces
/// as at the faces) and cut at the level, in steps of 2^-16, which keeps the number of voxels, or
/// else a little less: the surface moves by its mean curvature less the average of that, so that
/// necks fill and tips recede while the volume stays. After each round a voxel has the label of the
/// nearest voxel of the round before. Works in blocks of 128^3: no dense array over the box.
struct BedOptions {
  Coord size{180, 180, 180};
  uint64_t seed = 1;
  double minRadius = 12, maxRadius = 22;
  int rounds = 5;  ///< 0..1000
};
Sample generateBed(const BedOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
