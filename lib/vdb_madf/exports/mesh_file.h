// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/labels/grain_colors.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

/// What a mesh file says beyond the mesh.
struct MeshFileOptions {
  /// Index to world. The centre of voxel (i,j,k) lies at the world position of (i,j,k), so a
  /// voxel's faces half a voxel from it: the half voxel is in the points already.
  openvdb::math::Transform::ConstPtr transform;  ///< null: identity
  std::string lengthUnit;  ///< for comments in the file; empty: one unit is one voxel
  GrainColors colors;
};

/// Writes all grains into one file, whole or not at all, by ending:
/// - .ply: binary; points with colour and int `grain_id`, faces with int `grain_id` and colour
/// - .obj: a group `grain_000123` per grain, points with colour
/// - .stl: binary, all triangles; the grains are not told apart (see writeStlFolder)
/// - .vtp: VTK polygons, appended raw; per point and per polygon Int32 `grain_id` and UInt8 `color`
/// An empty mesh is written as a file without faces.
/// @throw InvalidInput for another ending or a transform that is not linear; IoError; Interrupted.
void writeMesh(const std::string& path, const GrainMesh& mesh, const MeshFileOptions& options,
               Interrupter* interrupter = nullptr);
/// True if writeMesh knows the ending.
bool isMeshEnding(const std::string& path);

/// One binary STL per grain, `grain_000123.stl`, in a folder, which is made if need be (not those
/// above it). All files appear together, whole, or none. @throw as writeMesh; IoError if the folder
/// has such a file of another grain, which would pass for one of this sample.
void writeStlFolder(const std::string& folder, const GrainMesh& mesh,
                    const MeshFileOptions& options, Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
