// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// What level sets measure the distance to, and how far.
struct LevelSetOptions {
  int smoothing = 0;       ///< of the mesh that the distances are measured to; see grain_mesh.h
  float halfWidth = 3.0f;  ///< of the narrow band, voxels, 1 .. 16
};

/// A narrow-band level set of every label, named `grain_000123`, ascending: signed distance in
/// world units to the nearest of all triangles of the grain's mesh, negative in the grain's voxels.
/// It is right to 1e-6 voxels and the rounding to float; the voxels nearer than the half width are
/// active. Time goes with the voxels of the bands. An empty grid has no level sets.
/// @throw InvalidInput if there are more than kMaxGrainGrids labels, for voxels that are no cubes,
/// or as grainMesh(); Interrupted.
std::vector<FloatGrid::Ptr> grainLevelSets(const Int32Grid& labels,
                                           const LevelSetOptions& options = {},
                                           Interrupter* interrupter = nullptr);

/// The level set of all labels as one object, named `surface`.
FloatGrid::Ptr surfaceLevelSet(const Int32Grid& labels, const LevelSetOptions& options = {},
                               Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
