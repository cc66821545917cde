// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

/// The surfaces of all grains. Each grain has its own points and triangles, so that it is a closed
/// mesh by itself; where two grains touch, their points have the same coordinates to the bit and
/// their triangles the same corners, turned over: no gap, no overlap.
struct GrainMesh {
  std::vector<int32_t> labels;  ///< of the grains, ascending
  /// Grain g has points [firstPoint[g], firstPoint[g + 1]), and triangles likewise.
  std::vector<uint32_t> firstPoint{0}, firstTriangle{0};
  std::vector<openvdb::Vec3f> points;  ///< index coordinates; voxel (i,j,k) is i - 1/2 .. i + 1/2
  /// Corners, as places in `points`; counterclockwise seen from outside the grain.
  std::vector<std::array<uint32_t, 3>> triangles;
};

/// How smooth a mesh is, and how fine.
struct GrainMeshOptions {
  /// Rounds of smoothing, 0 .. 1000; 0: the faces of the voxels, whose volume is exactly theirs.
  int smoothing = 0;
  /// Simplify to so many triangles of all grains together, or fewer; 0: all that there are. No
  /// grain and no contact is given up for it: where that takes more triangles, there are more.
  uint64_t triangles = 0;
  /// In voxels, 0 or more: simplify no further where that would move the surface by more, even if
  /// there are more triangles than asked for.
  double error = std::numeric_limits<double>::infinity();
};

/// Meshes every label (active, > 0) in one pass over the leaves, whatever their number.
///
/// A grain's surface is that of its voxels joined through faces: where they touch along an edge or
/// at a corner only, the surface has points of its own on either side, so that around every point
/// there is one disc; nor does the background pierce a grain at a single corner. Every edge of a
/// grain has two triangles: an edge of the lattice where there would be four has points of its own
/// in its middle, for all grains around it. The Euler number of a grain's surface is
/// points - triangles / 2.
///
/// Smoothed, it is a constrained surface net (Gibson 1998; for many labels: Frisken 2022): the
/// points shared by all grains at a lattice corner move towards the mean of those they are linked
/// to, points on lines where three labels meet along these lines, at most half a voxel along each
/// axis from where they were. Then the points move along the gradients of the grains' volumes until
/// these are the voxels' again (to 0.1 %, where half a voxel suffices). Where the labels' box
/// (storedDomain()) is known, points on its faces stay on them, and lines where these meet the free
/// surface follow them as lines between three labels do: the mesh is flat there, to the bit.
///
/// Simplified, edges have collapsed, those of least error first: a point goes to a neighbor, in all
/// grains at once, points on lines where three labels (the outside of the domain counts) meet along
/// these lines, and where lines meet points stay. So interfaces are shared as ever, every grain
/// stays closed with its Euler number (a ball keeps 4 triangles or more), no contact vanishes, and
/// the faces of the domain stay flat. The error is the root of the mean squared distance to the
/// planes of the triangles that a point stands for (Garland and Heckbert 1997), not a bound on the
/// distance. At last points move, at most a voxel along each axis, until the volumes are the
/// voxels' again; with too few triangles they cannot. Memory: some 200 bytes a triangle of the mesh
/// that is simplified, which may have 1,431,655,765; time: some 4 times that of meshing.
///
/// Points and triangles are ordered by label, then by place: the same for any number of threads.
/// An empty grid has an empty mesh.
/// @throw InvalidInput for options out of range or more than 2^32 - 1 points or triangles;
///   Interrupted.
GrainMesh grainMesh(const Int32Grid& labels, const GrainMeshOptions& options = {},
                    Interrupter* interrupter = nullptr);

/// Meshes some grains alone (select_grains.h), at their cost: each mesh is closed. As voxels it is
/// their part of the mesh of all, to the bit (but where a grain that is left out cuts an edge);
/// smoothed or simplified they move as if no other grain were there.
/// @throw InvalidInput also if there is no such grain; Interrupted.
GrainMesh meshOfGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                       const GrainMeshOptions& options = {}, Interrupter* interrupter = nullptr);

/// Triangles of grainMesh() before it is simplified, without meshing: two for each voxel face of a
/// grain that is not towards a voxel of its own; edges that are cut in the middle, which are rare,
/// add some. @throw Interrupted
uint64_t countTriangles(const Int32Grid& labels, Interrupter* interrupter = nullptr);
/// Counts those of labels in slabs, two of which are in memory at a time.
/// @throw Interrupted; what reading throws
uint64_t countTriangles(const LabelSlabs& labels, Interrupter* interrupter = nullptr);

/// Signed volume of each grain, in voxels.
std::vector<double> meshVolumes(const GrainMesh& mesh);

}  // namespace vdb_madf
