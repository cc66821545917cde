// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/mesh_distance.h"

#include <array>
#include <cassert>

#include "vdb_madf/shapes/detail/block_distances.h"
#include "vdb_madf/shapes/detail/whole_places.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

/// Voxels; whole leaves.
constexpr int kBlockShift = 6, kBlockSide = 1 << kBlockShift;
static_assert(kBlockSide <= BlockDistances::kMaxSide);

Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a);
  const double length = normal.length();
  return length > 0 ? normal * (1 / length) : Vec3d(0);
}

std::vector<std::array<uint32_t, 3>> trianglesOf(const GrainMesh& mesh, size_t grain) {
  std::vector<std::array<uint32_t, 3>> triangles(
      mesh.triangles.begin() + mesh.firstTriangle[grain],
      mesh.triangles.begin() + mesh.firstTriangle[grain + 1]);
  for (auto& triangle : triangles)
    for (uint32_t& corner : triangle) corner -= mesh.firstPoint[grain];
  return triangles;
}

std::vector<uint32_t> cornersOf(const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<uint32_t> corners;
  corners.reserve(3 * triangles.size());
  for (const auto& triangle : triangles)
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

}  // namespace

MeshDistance::MeshDistance(const GrainMesh& mesh, size_t grain, float reach)
    : points_(mesh.points.data() + mesh.firstPoint[grain]),
      pointCount_(mesh.firstPoint[grain + 1] - mesh.firstPoint[grain]),
      triangles_(trianglesOf(mesh, grain)),
      reach_(reach),
      cornersOfPoint_(cornersOf(triangles_), pointCount_) {
  normals_.reserve(triangles_.size());
  for (const auto& [a, b, c] : triangles_)
    normals_.push_back(normalOf(Vec3d(points_[a]), Vec3d(points_[b]), Vec3d(points_[c])));
  listBlocks();
}

CoordBBox MeshDistance::reached(const Vec3f& low, const Vec3f& high) const {
  CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = ceilOf(double(low[axis]) - double(reach_));
    box.max()[axis] = floorOf(double(high[axis]) + double(reach_));
  }
  return box;
}

void MeshDistance::listBlocks() {
  CoordBBox whole;
  for (uint32_t i = 0; i < pointCount_; ++i) whole.expand(reached(points_[i], points_[i]));
  if (whole.empty()) return;
  const Coord low = whole.min() & ~7, high = (whole.max() & ~7).offsetBy(7);
  const Coord count = ((high - low) >> kBlockShift).offsetBy(1);
  for (int x = 0; x < count.x(); ++x)
    for (int y = 0; y < count.y(); ++y)
      for (int z = 0; z < count.z(); ++z) {
        const Coord start = low.offsetBy(x * kBlockSide, y * kBlockSide, z * kBlockSide);
        blocks_.emplace_back(start, Coord::minComponent(high, start.offsetBy(kBlockSide - 1)));
      }
  pointsOfBlock_.resize(blocks_.size());
  trianglesOfBlock_.resize(blocks_.size());
  const auto list = [&](std::vector<std::vector<uint32_t>>& lists, uint32_t item,
                        const CoordBBox& box) {
    const Coord first = (box.min() - low) >> kBlockShift, last = (box.max() - low) >> kBlockShift;
    for (int x = first.x(); x <= last.x(); ++x)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int z = first.z(); z <= last.z(); ++z)
          lists[size_t((x * count.y() + y) * count.z() + z)].push_back(item);
  };
  for (uint32_t i = 0; i < pointCount_; ++i)
    list(pointsOfBlock_, i, reached(points_[i], points_[i]));
  for (uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto& [a, b, c] = triangles_[i];
    using openvdb::math::maxComponent;
    using openvdb::math::minComponent;
    list(trianglesOfBlock_, i,
         reached(minComponent(points_[a], minComponent(points_[b], points_[c])),
                 maxComponent(points_[a], maxComponent(points_[b], points_[c]))));
  }
}

uint32_t MeshDistance::triangleBeyond(uint32_t a, uint32_t b) const {
  for (uint32_t i = cornersOfPoint_.first[a]; i < cornersOfPoint_.first[a + 1]; ++i) {
    const uint32_t corner = cornersOfPoint_.items[i];
    if (triangles_[corner / 3][(corner % 3 + 2) % 3] == b) return corner / 3;
  }
  return SharedMesh::kNone;
}

std::vector<float> MeshDistance::squaredDistances(size_t block) const {
  BlockDistances distances(blocks_[block], reach_);
  for (const uint32_t point : pointsOfBlock_[block]) distances.addPoint(points_[point]);
  for (const uint32_t number : trianglesOfBlock_[block]) {
    const Triangle& triangle = triangles_[number];
    const std::array<Vec3d, 3> at{points_[triangle[0]], points_[triangle[1]], points_[triangle[2]]};
    distances.addTriangle(at[0], at[1], at[2]);
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t a = triangle[n], b = triangle[(n + 1) % 3];
      if (a > b) continue;  // the other triangle's
      const uint32_t beyond = triangleBeyond(a, b);
      assert(beyond != SharedMesh::kNone);
      distances.addEdge(at[n], at[(n + 1) % 3], normals_[number], normals_[beyond]);
    }
  }
  return distances.squares();
}

}  // namespace vdb_madf::detail
