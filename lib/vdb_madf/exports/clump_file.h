// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/exports/clump_bonds.h"
#include "vdb_madf/shapes/clumps.h"

namespace vdb_madf {

/// Writes world centers and radii, whole or not at all, by ending:
/// - .csv: grain_id, x, y, z, radius
/// - .txt: x y z radius clump, a line per ball, as YADE exports and ymport.textClumps reads; clumps
///   are numbered from 0
/// - .data: LAMMPS data for `atom_style hybrid sphere molecular`: one atom per ball, the grain as
///   molecule (numbered from 1), for `fix rigid/small molecule`. That refuses a body of one atom:
///   at the end of the list a grain of one ball has a second one, of half the radius, within it.
///   Balls overlap: their density is such that those of a grain together weigh what the grain does
///   at density 1. With \p bonds (the other endings leave them out) also a section Bonds, in which
///   each has a type of its own: its number in the file of writeClumpBonds()
/// @throw InvalidInput for another ending, or voxels that are mirrored; IoError.
void writeClumps(const std::string& path, const std::vector<Clump>& clumps,
                 const openvdb::math::Transform& transform,
                 const std::vector<ClumpBond>& bonds = {}, Interrupter* interrupter = nullptr);
/// Writes a line per grain, whole or not at all: `grain_id`, `voxels`, `balls`, `uncovered` (voxels
/// of the grain in no ball), `outside` (voxels of the balls that are not the grain's),
/// `volume_error` ((outside - uncovered) / voxels), `farthest` (largest distance of a voxel from
/// the balls, world).
/// @throw InvalidInput for an ending other than .csv, or voxels that are mirrored; IoError.
void writeClumpCover(const std::string& path, const std::vector<Clump>& clumps,
                     const openvdb::math::Transform& transform, Interrupter* interrupter = nullptr);
/// Says how well balls cover their grains, and how many grains have none, which a file leaves out.
/// \p areCubes: what the voxels are, for the unit of lengths
std::string describeClumps(const std::vector<Clump>& clumps, bool areCubes);
/// True if writeClumps knows the ending.
bool isClumpEnding(const std::string& path);

}  // namespace vdb_madf
