// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf {

/// The points of a mesh in the world. Programs that read meshes, all those that read STL, take
/// points at one place for one point. So points that a grain has at one place, where its voxels
/// touch along an edge or at a corner only, go into the grain by 2^-14 of a voxel, or by as much
/// more as 32 bits take to tell them apart: merged by place, its surface is what it was. No other
/// point moves. Points stay together where 2^-6 of a voxel is too little, which is so some 2^18
/// voxels from the origin.
std::vector<openvdb::Vec3f> worldPoints(const GrainMesh& mesh,
                                        const openvdb::math::Transform& transform);

}  // namespace vdb_madf
