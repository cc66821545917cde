// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/measure/grain_network.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

/// What a mesh file says beyond the mesh.
struct MeshFileOptions {
  /// Index to world. The center of voxel (i,j,k) lies at the world position of (i,j,k), so a
  /// voxel's faces half a voxel from it: the half voxel is in the points already.
  openvdb::math::Transform::ConstPtr transform;  ///< null: identity
  std::string lengthUnit;  ///< for comments in the file; empty: one unit is one voxel
  GrainColors colors;
  // What follows is for .glb alone.
  const GrainNetwork* measured = nullptr;  ///< its numbers become properties of the grains
  bool shadeSmooth = false;                ///< with normals; else triangles are shown as planes
};

/// The length unit of a grid's world: of its voxel size; empty where one unit is one voxel, and "an
/// unknown unit" where it is not.
std::string worldUnit(const openvdb::GridBase& grid);

/// Writes all grains into one file, whole or not at all, by ending:
/// - .ply: binary; points with color and int `grain_id`, faces with int `grain_id` and color
/// - .obj: a group `grain_000123` per grain, points with color; materials in the .mtl beside it
/// - .stl: binary, all triangles; the grains are not told apart (see writeStlFolder)
/// - .vtp: VTK polygons, appended raw; per point and per polygon Int32 `grain_id` and UInt8 `color`
/// - .glb: glTF 2.0; a node `grain_000123` per grain, at the centroid of what its surface encloses,
///   from which its points are counted, with a material of its color, and the label and the numbers
///   of `measured` in its `extras`, by their names; what is not known is left out.
///   One unit of length is that of the grid, though glTF says meters; y is upwards, so that a
///   program with z upwards, which turns such files, shows the places of the grid.
/// An empty mesh is written as a file without faces.
/// @throw InvalidInput for another ending, a transform that is not linear, or more than 4 GiB in a
///   .glb; IoError; Interrupted.
void writeMesh(const std::string& path, const GrainMesh& mesh, const MeshFileOptions& options,
               Interrupter* interrupter = nullptr);
/// True if writeMesh knows the ending.
bool isMeshEnding(const std::string& path);
bool isGlb(const std::string& path);
/// Before the grains are meshed. @throw InvalidInput if so many triangles would not fit the format.
void checkMeshRoom(const std::string& path, uint64_t triangles, const MeshFileOptions& options);

/// One binary STL per grain, `grain_000123.stl`, in a folder, which is made if need be (not those
/// above it). All files appear together, whole, or none. @throw as writeMesh; IoError if the folder
/// has such a file of another grain, which would pass for one of this sample.
void writeStlFolder(const std::string& folder, const GrainMesh& mesh,
                    const MeshFileOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
