// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_madf/shapes/detail/shared_mesh.h"
#include "vdb_madf/shapes/grain_mesh.h"

namespace vdb_madf::detail {

/// Exact distances to the closed mesh of a grain, for the voxels nearer than a reach, in blocks.
///
/// The point of a mesh that is nearest to a voxel lies within a triangle, within an edge, or is one
/// of its points. The first can be for the voxels above and below the triangle alone, the second
/// for those of the wedge between the two triangles of the edge. So each triangle and edge is
/// measured for these few voxels, each point for all within reach, and time goes with the voxels of
/// the band (after Mauch 2003, who knows the voxels of points, too).
class MeshDistance {
 public:
  /// Refers to the mesh. \p reach: in voxels, 1 or more
  MeshDistance(const GrainMesh& mesh, size_t grain, float reach);

  /// Boxes of whole leaves, apart from each other, which hold all voxels within reach.
  const std::vector<CoordBBox>& blocks() const { return blocks_; }

  /// The squared distances of the voxels of a block, z fastest; reach^2 for those that are as far
  /// or farther. Rounded to float, and right to 1e-6 voxels.
  std::vector<float> squaredDistances(size_t block) const;

 private:
  using Triangle = std::array<uint32_t, 3>;

  void listBlocks();
  /// The voxels within reach of a box along each axis.
  CoordBBox reached(const openvdb::Vec3f& low, const openvdb::Vec3f& high) const;
  /// The triangle that has the edge from b to a.
  uint32_t triangleBeyond(uint32_t a, uint32_t b) const;

  const openvdb::Vec3f* points_;  ///< of the grain
  uint32_t pointCount_;
  std::vector<Triangle> triangles_;      ///< of these
  std::vector<openvdb::Vec3d> normals_;  ///< of the triangles, of length 1; 0: it has no area
  float reach_;
  Lists cornersOfPoint_;  ///< triangle * 3 + corner
  std::vector<CoordBBox> blocks_;
  std::vector<std::vector<uint32_t>> pointsOfBlock_, trianglesOfBlock_;
};

}  // namespace vdb_madf::detail
