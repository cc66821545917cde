// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/remesh.h"

#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <vector>

namespace vdb_madf::detail {

GrainMesh remesh(const GrainMesh& mesh, double facet) {
  using openvdb::Vec3s;
  constexpr float kHalfWidth = 2;  // of the band, facets: the surface is within one
  std::vector<Vec3s> points;
  for (const Vec3s& point : mesh.points) points.push_back(point / float(facet));
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  const auto transform = openvdb::math::Transform::createLinearTransform();
  const FloatGrid::Ptr distances =
      openvdb::tools::meshToLevelSet<FloatGrid>(*transform, points, triangles, kHalfWidth);

  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*distances, points, triangles, quads, 0, 0);
  GrainMesh result;
  result.labels = mesh.labels;
  for (const Vec3s& point : points) result.points.push_back(point * float(facet));
  // (Clockwise seen from outside.)
  for (const openvdb::Vec3I& t : triangles) result.triangles.push_back({t[0], t[2], t[1]});
  for (const openvdb::Vec4I& q : quads) {
    result.triangles.push_back({q[0], q[2], q[1]});
    result.triangles.push_back({q[0], q[3], q[2]});
  }
  result.firstPoint.push_back(uint32_t(result.points.size()));
  result.firstTriangle.push_back(uint32_t(result.triangles.size()));
  return result;
}

}  // namespace vdb_madf::detail
