// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/measure/measure_grains.h"
#include "vdb_madf/shapes/clumps.h"

namespace vdb_madf {

/// Writes the clumps that have balls as LoadClumps() of MercuryDPM (Drivers/Clump) reads them,
/// whole or not at all; nothing is replaced. Of each a folder `grain_000123`, world units:
/// - `Clump/Clump.txt`: x,y,z,radius per ball, from the grain's centroid along its axes
/// - `Inertia/Mass.txt`: its volume, which is its mass at density 1
/// - `Inertia/TOI.txt`: its tensor of inertia at density 1, along its axes: a diagonal
/// - `Inertia/PD.txt`: its axes of inertia in the world, as columns: with these it lies as it does
///   in the scan
/// Mass and inertia are those of the grain's voxels, not of the balls. Beside the folders
/// `places.csv` has the centroids: `grain_id`, `x`, `y`, `z`.
/// \p grains: of measure(), by label. \p transform: of the labels.
/// @throw InvalidInput if a clump has balls and its grain is not there, or voxels are mirrored;
///   IoError.
void writeClumpFolder(const std::string& folder, const std::vector<Clump>& clumps,
                      const std::vector<GrainMeasures>& grains,
                      const openvdb::math::Transform& transform);

}  // namespace vdb_madf
