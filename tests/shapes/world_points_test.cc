// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/world_points.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/mesh_checks.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;
using openvdb::Vec3f;
using openvdb::math::Transform;

namespace {

constexpr double kEdge = 8.5e-3;

/// A grain of some of the voxels around a corner, which may have another grain in all others.
LabelMap around(const Coord& corner, int set, int32_t beyond) {
  LabelMap voxels;
  for (int n = 0; n < 8; ++n) {
    const int32_t label = (set >> n & 1) ? 1 : beyond;
    if (label > 0) voxels[corner + Coord(n >> 2, n >> 1 & 1, n & 1)] = label;
  }
  return voxels;
}

void checkMerged(const GrainMesh& mesh, const Transform& transform) {
  const std::vector<Vec3f> points = worldPoints(mesh, transform);
  const GrainMesh merged = mergedByPlace(mesh, points);
  CHECK(whyNotClosed(merged) == "");
  CHECK(whyNoDisc(merged) == "");
  for (size_t i = 0; i < points.size(); ++i)
    REQUIRE((Vec3d(points[i]) - transform.indexToWorld(Vec3d(mesh.points[i]))).length() <
            kEdge / 500);
  GrainMesh moved = mesh;
  moved.points = points;
  const std::vector<double> volume = meshVolumes(mesh), found = meshVolumes(moved);
  for (size_t g = 0; g < volume.size(); ++g)
    CHECK(found[g] / (kEdge * kEdge * kEdge) == Approx(volume[g]).epsilon(0.002));
}

}  // namespace

TEST_CASE("world_points: however voxels touch, a grain merged by place is one sheet",
          "[world_points]") {
  const auto transform = Transform::createLinearTransform(kEdge);
  for (const Coord& corner : {Coord(0), Coord(2999, -7, 1500)})
    for (int set = 1; set < 256; ++set)
      for (const int32_t beyond : {0, 2})
        for (const int smoothing : {0, 3}) {
          CAPTURE(corner, set, beyond, smoothing);
          checkMerged(grainMesh(*labelGrid(around(corner, set, beyond)), {smoothing}), *transform);
        }
}

TEST_CASE("world_points: grains of noise, smoothed and simplified", "[world_points]") {
  const auto transform = Transform::createLinearTransform(kEdge);
  const auto grid = labelGrid(randomLabels(3, Coord(-5, 40, 7), 12, 3, 60));
  for (const int smoothing : {0, 10}) {
    GrainMeshOptions options;
    options.smoothing = smoothing;
    checkMerged(grainMesh(*grid, options), *transform);
    options.triangles = 1000;
    checkMerged(grainMesh(*grid, options), *transform);
  }
}

TEST_CASE("world_points: points that are alone stay where they are", "[world_points]") {
  const auto transform = Transform::createLinearTransform(kEdge);
  const GrainMesh mesh = grainMesh(*labelGrid(twoBalls({4, 5, -6}, 6)));
  const std::vector<Vec3f> points = worldPoints(mesh, *transform);
  for (size_t i = 0; i < points.size(); ++i)
    REQUIRE(points[i] == Vec3f(transform->indexToWorld(Vec3d(mesh.points[i]))));
}
