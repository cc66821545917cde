// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/level_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_name.h"
#include "vdb_madf/shapes/grain_mesh.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

using openvdb::Vec3d;

double toSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a;
  const double length = along.lengthSqr();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0;
  return (p - a - t * along).length();
}

double toTriangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double edges = std::min({toSegment(p, a, b), toSegment(p, b, c), toSegment(p, c, a)});
  const Vec3d normal = (b - a).cross(c - a);
  const double area = normal.length();
  const bool isAbove = (b - a).cross(p - a).dot(normal) > 0 &&
                       (c - b).cross(p - b).dot(normal) > 0 && (a - c).cross(p - c).dot(normal) > 0;
  return isAbove ? std::min(edges, std::abs((p - a).dot(normal)) / area) : edges;
}

/// To all triangles of a grain, in voxels.
double toMesh(const Vec3d& p, const GrainMesh& mesh, size_t grain) {
  double nearest = std::numeric_limits<double>::infinity();
  for (uint32_t i = mesh.firstTriangle[grain]; i < mesh.firstTriangle[grain + 1]; ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    nearest = std::min(nearest, toTriangle(p, Vec3d(mesh.points[a]), Vec3d(mesh.points[b]),
                                           Vec3d(mesh.points[c])));
  }
  return nearest;
}

/// The voxels around a grain whose values are not what the distances to all triangles say.
size_t wrongVoxels(const FloatGrid& levelSet, const LabelMap& voxels, const GrainMesh& mesh,
                   size_t grain, float halfWidth) {
  constexpr double kClose = 1e-5;
  const double edge = levelSet.voxelSize()[0];
  CoordBBox box;
  for (const auto& [p, label] : voxels)
    if (label == mesh.labels[grain]) box.expand(p);
  box.expand(int(halfWidth) + 3);
  size_t wrong = 0;
  for (auto p = box.begin(); p; ++p) {
    const auto found = voxels.find(*p);
    const bool inside = found != voxels.end() && found->second == mesh.labels[grain];
    const double away = toMesh((*p).asVec3d(), mesh, grain);
    float value = 0;
    const bool isActive = levelSet.tree().probeValue(*p, value);
    const double wanted = edge * std::min(away, double(halfWidth)) * (inside ? -1 : 1);
    wrong += std::abs(double(value) - wanted) > kClose * edge;
    if (std::abs(away - double(halfWidth)) > kClose)
      wrong += isActive != (away < double(halfWidth));
  }
  return wrong;
}

}  // namespace

TEST_CASE("level_sets: negative inside, zero on the faces of the voxels", "[level_sets]") {
  constexpr double kEdge = 0.5;
  const LabelMap voxels = twoBalls({5, -6, 7}, 6);
  const auto grid = labelGrid(voxels);
  setVoxelSize(*grid, VoxelSize{kEdge * 1e-3});
  const auto grains = grainLevelSets(*grid);
  REQUIRE(grains.size() == 2);
  CHECK(grains[0]->getName() == "grain_000003");
  CHECK(grains[1]->getName() == "grain_000007");
  const auto surface = surfaceLevelSet(*grid);
  CHECK(surface->getName() == "surface");

  CoordBBox box = grid->evalActiveVoxelBoundingBox();
  box.expand(4);
  for (const auto& [label, levelSet] :
       {std::pair{3, grains[0]}, std::pair{7, grains[1]}, std::pair{0, surface}}) {
    CHECK(levelSet->getGridClass() == openvdb::GRID_LEVEL_SET);
    CHECK(levelSet->transform() == grid->transform());
    size_t wrong = 0;
    for (auto p = box.begin(); p; ++p) {
      const auto found = voxels.find(*p);
      const bool inside = found != voxels.end() && (label == 0 || found->second == label);
      const double value = double(levelSet->tree().getValue(*p));
      // A voxel's center is half a voxel from its faces, or farther.
      wrong += inside ? value > -0.49 * kEdge : value < 0.49 * kEdge;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("level_sets: the distances to the nearest of all triangles", "[level_sets]") {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    const int smoothing = seed % 3 == 0 ? 0 : seed % 3 == 1 ? 1 : 10;
    const float halfWidth = seed % 2 ? 3.0f : 1.5f;
    INFO("seed " << seed);
    const LabelMap voxels = randomLabels(seed, {-60, 58, 3}, 6, 2, seed < 4 ? 90 : 40);
    const auto grid = labelGrid(voxels);
    setVoxelSize(*grid, VoxelSize{2e-3});
    const auto grains = grainLevelSets(*grid, {smoothing, halfWidth});
    GrainMeshOptions options;
    options.smoothing = smoothing;
    const GrainMesh mesh = grainMesh(*grid, options);
    REQUIRE(grains.size() == mesh.labels.size());
    for (size_t grain = 0; grain < grains.size(); ++grain)
      CHECK(wrongVoxels(*grains[grain], voxels, mesh, grain, halfWidth) == 0);
  }
}

TEST_CASE("level_sets: a body larger than a block of the work, in a wide band", "[level_sets]") {
  LabelMap voxels;
  for (int i = -70; i < 70; ++i)
    for (int j = 0; j < 3; ++j) voxels[{i, i / 2, j - i}] = voxels[{i, i / 2 + 1, j - i}] = 1;
  const auto grid = labelGrid(voxels);
  GrainMeshOptions options;
  options.smoothing = 3;
  const GrainMesh mesh = grainMesh(*grid, options);
  const auto surface = surfaceLevelSet(*grid, {3, 5.5f});
  size_t wrong = 0;
  for (auto leaf = surface->tree().cbeginLeaf(); leaf; ++leaf)
    for (int i = 0; i < 512; i += 37) {
      const Coord p = leaf->offsetToGlobalCoord(openvdb::Index(i));
      const double wanted =
          std::min(toMesh(p.asVec3d(), mesh, 0), 5.5) * (voxels.count(p) ? -1 : 1);
      wrong += std::abs(double(leaf->getValue(openvdb::Index(i))) - wanted) > 1e-5;
    }
  CHECK(wrong == 0);
  // As far from the origin as voxels may lie.
  const Coord far(20000, -20000, 20000);
  LabelMap moved;
  for (const auto& [p, label] : twoBalls(far, 5)) moved[p] = label;
  const auto movedGrid = labelGrid(moved);
  const GrainMesh movedMesh = grainMesh(*movedGrid, options);
  CHECK(wrongVoxels(*grainLevelSets(*movedGrid, {3, 3.0f})[0], moved, movedMesh, 0, 3.0f) == 0);
}

TEST_CASE("level_sets: limits", "[level_sets]") {
  LabelMap many;
  for (int i = 0; i <= int(kMaxGrainGrids); ++i) many[{i, 0, 0}] = i + 1;
  CHECK_THROWS_AS(grainLevelSets(*labelGrid(many)), InvalidInput);
  CHECK(grainLevelSets(*labelGrid({})).empty());
  CHECK_THROWS_AS(surfaceLevelSet(*labelGrid({})), InvalidInput);
  CHECK_THROWS_AS(surfaceLevelSet(*labelGrid({{Coord(0), 1}}), {0, 0.5f}), InvalidInput);
}
