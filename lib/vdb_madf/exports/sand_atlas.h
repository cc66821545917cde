// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// What a folder for the Sand Atlas holds, and what it does not.
struct SandAtlasCounts {
  size_t particles = 0;
  size_t atFaces = 0;  ///< grains that touch the faces of the domain
};

/// Writes the grains that do not touch the faces of the domain as the Sand Atlas
/// (sand-atlas.scigem.com) has them, whole or not at all; nothing is replaced. They are particles,
/// from 1 on, in the order of their labels. In a folder NAME:
/// - `vdb/particle_00001.vdb`: the fog volume `density`, 1 and active at the grain's voxels, else
///   0. One voxel is one unit; the first voxels lie at 1.
/// - `stl_ORIGINAL/particle_00001.stl` (binary, mm): grainMesh(), its center of volume at the
///   origin, scaled to the volume of the voxels. `stl_100`, `stl_30`, `stl_10`, `stl_3`: that
///   in facets of one size, by OpenVDB's level sets, with so many across the smallest axis of the
///   ellipsoid of the grain's second moments, none below 1/4 voxel; finer ones where less than half
///   of the grain would be left.
/// - `NAME.csv`: `Particle ID`, `Volume (µm³)`, `Equivalent Diameter (µm)`, `Major Axis Length
///   (µm)`, `Middle ...`, `Minor ...`, `True Sphericity (-)`, `Convexity (-)`, `Flatness (-)`,
///   `Elongation (-)`, `Compactness (-)`: our measures (GrainMeasures), compactness being the cube
///   of the sphericity. Empty: not known.
/// - `NAME.json`: title (NAME), number of particles, micrometers per voxel, and what the site may
///   know of a sand besides, null.
/// Axes are x, y, z. Memory: that of measure(), and a grain with its meshes per thread. The bytes
/// depend on labels, options and NAME alone. \p smoothing: of GrainMeshOptions
/// @throw InvalidInput without a voxel size, for voxels that are no cubes or mirrored, if all
///   grains touch the faces, or as measure() and grainMesh(); IoError; Interrupted.
SandAtlasCounts writeSandAtlas(const std::string& folder, const Int32Grid& labels,
                               int smoothing = 10, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
