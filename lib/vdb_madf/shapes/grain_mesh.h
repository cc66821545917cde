// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// The surfaces of all grains. Each grain has its own points and triangles, so that it is a closed
/// mesh by itself; where two grains touch, their points have the same coordinates to the bit and
/// their triangles the same corners, turned over: no gap, no overlap.
struct GrainMesh {
  std::vector<int32_t> labels;  ///< of the grains, ascending
  /// Grain g has points [firstPoint[g], firstPoint[g + 1]), and triangles likewise.
  std::vector<uint32_t> firstPoint{0}, firstTriangle{0};
  std::vector<openvdb::Vec3f> points;  ///< index coordinates; voxel (i,j,k) is i - 1/2 .. i + 1/2
  /// Into `points`; counterclockwise seen from outside the grain.
  std::vector<std::array<uint32_t, 3>> triangles;
};

struct GrainMeshOptions {
  /// Rounds of smoothing, 0 .. 1000; 0: the faces of the voxels, whose volume is exactly theirs.
  int smoothing = 0;
};

/// Meshes every label (active, > 0) in one pass over the leaves, whatever their number.
///
/// A grain's surface is that of its voxels joined through faces: where they touch along an edge or
/// at a corner only, the surface has points of its own on either side, so that around every point
/// there is one disc; nor does the background pierce a grain at a single corner. The Euler number
/// of a grain's surface is points - triangles / 2.
///
/// Smoothed, it is a constrained surface net (Gibson 1998; for many labels: Frisken 2022): the
/// points shared by all grains at a lattice corner move towards the mean of those they are linked
/// to, points on lines where three labels meet along these lines, at most half a voxel along each
/// axis from where they were. Then the points move along the gradients of the grains' volumes until
/// these are the voxels' again (to 0.1 %, where half a voxel suffices).
///
/// Points and triangles are ordered by label, then by place: the same for any number of threads.
/// An empty grid has an empty mesh.
/// @throw InvalidInput for options out of range or more than 2^32 - 1 points or triangles;
///   Interrupted.
GrainMesh grainMesh(const Int32Grid& labels, const GrainMeshOptions& options = {},
                    Interrupter* interrupter = nullptr);

/// The same of some grains alone (select_grains.h), at their cost: each a closed mesh. Unsmoothed it
/// is their part of the mesh of all, to the bit; smoothed they move as if no other grain were there.
/// @throw InvalidInput also if there is no such grain; Interrupted.
GrainMesh meshOfGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                       const GrainMeshOptions& options = {}, Interrupter* interrupter = nullptr);

/// Triangles of grainMesh(), without meshing: two for each voxel face of a grain that is not
/// towards a voxel of its own. @throw Interrupted
uint64_t countTriangles(const Int32Grid& labels, Interrupter* interrupter = nullptr);

/// The smallest factor, from \p first on, by which reduced labels (reduced_labels.h) have a mesh of
/// at most so many triangles. Smoothing moves points only, so it does not matter.
/// @throw InvalidInput if that exceeds kMaxReduction, or no voxel would be left; Interrupted.
int reductionForTriangles(const Int32Grid& labels, uint64_t maxTriangles, int first = 1,
                          Interrupter* interrupter = nullptr);

/// Signed volume of each grain, in voxels.
std::vector<double> meshVolumes(const GrainMesh& mesh);

}  // namespace vdb_madf
