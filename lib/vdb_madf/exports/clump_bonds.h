// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_madf/measure/measure_bonds.h"
#include "vdb_madf/shapes/clumps.h"

namespace vdb_madf {

/// A bond between two clumps, for bonded-particle models: what holds together which two balls.
/// Lengths in shortest edges of a voxel.
struct ClumpBond {
  size_t firstClump = 0, secondClump = 0;  ///< among those with balls, from 0
  size_t firstBall = 0, secondBall = 0;    ///< places among all balls, clump after clump, from 0
  double distance = 0;                     ///< between the centers of these balls
  BondMeasures measures;                   ///< of the interface of the grains
};

/// A bond for each of \p bonds whose grains both have balls, in their order. Its balls are the pair
/// that is nearest, surface to surface (balls that overlap most come first; ties: the first pair).
/// \p clumps ascend by label, as clumps() makes them. \p transform: of the labels.
std::vector<ClumpBond> clumpBonds(const std::vector<Clump>& clumps,
                                  const std::vector<BondMeasures>& bonds,
                                  const openvdb::math::Transform& transform);

/// Writes a line per bond, world units, whole or not at all: `bond` (1, 2 ...), `first`,
/// `second` (ids of grains), `first_clump`, `second_clump`, `first_ball`, `second_ball` (numbers
/// from 0 in the files of writeClumps(); an atom of LAMMPS is its ball + 1), `distance` (of the two
/// balls' centers), `area`, `radius` (of the disc of this area), `centroid_x`, `_y`, `_z`,
/// `normal_x`, `_y`, `_z` (from the first to the second).
/// @throw InvalidInput for an ending other than .csv, or voxels that are mirrored; IoError.
void writeClumpBonds(const std::string& path, const std::vector<ClumpBond>& bonds,
                     const openvdb::math::Transform& transform, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
