// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/grain_mesh.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <set>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/label_slabs.h"
#include "support/mesh_checks.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3f;

namespace {

void checkExact(const LabelMap& voxels) {
  const GrainMesh mesh = grainMesh(*labelGrid(voxels));
  CHECK(whyNotClosed(mesh) == "");
  CHECK(whyNoDisc(mesh) == "");
  const auto volume = volumes(voxels), euler = eulerNumbers(voxels);
  const std::vector<double> found = meshVolumes(mesh);
  REQUIRE(mesh.labels.size() == volume.size());
  for (size_t g = 0; g < mesh.labels.size(); ++g) {
    CAPTURE(mesh.labels[g]);
    CHECK(found[g] == double(volume.at(mesh.labels[g])));  // to the bit
    const int64_t points = mesh.firstPoint[g + 1] - mesh.firstPoint[g],
                  triangles = mesh.firstTriangle[g + 1] - mesh.firstTriangle[g];
    CHECK(points - triangles / 2 == 2 * euler.at(mesh.labels[g]));
  }
}

/// Triangles of a grain that another grain has turned over.
size_t sharedTriangles(const GrainMesh& mesh, size_t a, size_t b) {
  std::multiset<Corners> others;
  for (uint32_t t = mesh.firstTriangle[b]; t < mesh.firstTriangle[b + 1]; ++t)
    others.insert(cornersOf(mesh, mesh.triangles[t], true));
  size_t count = 0;
  for (uint32_t t = mesh.firstTriangle[a]; t < mesh.firstTriangle[a + 1]; ++t)
    count += others.count(cornersOf(mesh, mesh.triangles[t], false));
  return count;
}

size_t contactFaces(const LabelMap& voxels, int32_t a, int32_t b) {
  size_t count = 0;
  for (const auto& [p, label] : voxels)
    for (const Coord& step : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}) {
      const auto other = voxels.find(p + step);
      if (other == voxels.end()) continue;
      count += std::min(label, other->second) == a && std::max(label, other->second) == b;
    }
  return count;
}

}  // namespace

TEST_CASE("grain_mesh: no voxel, one voxel", "[grain_mesh]") {
  const GrainMesh nothing = grainMesh(*labelGrid({}), {5});
  CHECK(nothing.labels.empty());
  CHECK(whyNotClosed(nothing) == "");

  const GrainMesh one = grainMesh(*labelGrid({{Coord(7, -8, 15), 9}}));
  REQUIRE(one.labels == std::vector<int32_t>{9});
  CHECK(one.points.size() == 8);
  CHECK(one.triangles.size() == 12);
  openvdb::BBoxd box;
  for (const Vec3f& p : one.points) box.expand(openvdb::Vec3d(p));
  CHECK(box.min() == openvdb::Vec3d(6.5, -8.5, 14.5));
  CHECK(box.max() == openvdb::Vec3d(7.5, -7.5, 15.5));
  checkExact({{Coord(7, -8, 15), 9}});
}

TEST_CASE("grain_mesh: every grain is closed and has its voxels' volume and Euler number",
          "[grain_mesh]") {
  checkExact(awkwardLabels());
  checkExact(twoBalls({3, -4, 5}, 7));
  for (unsigned seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    checkExact(
        randomLabels(seed, Coord(-5, 3, int(seed)), 12, 1 + int(seed % 3), 25 + 6 * int(seed)));
  }
}

TEST_CASE("grain_mesh: the checks see a hole, a turned triangle and a pinched point",
          "[grain_mesh]") {
  GrainMesh mesh = grainMesh(*labelGrid(twoBalls({0, 0, 0}, 4)));
  REQUIRE(whyNotClosed(mesh) == "");
  GrainMesh turned = mesh;
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  CHECK(whyNotClosed(turned) != "");
  mesh.triangles.pop_back();
  --mesh.firstTriangle.back();
  CHECK(whyNotClosed(mesh) != "");

  // Two voxels at a corner, with one point there instead of two.
  GrainMesh pinched = grainMesh(*labelGrid({{Coord(-1, -1, -1), 1}, {Coord(0, 0, 0), 1}}));
  REQUIRE(whyNoDisc(pinched) == "");
  std::vector<uint32_t> same;
  for (uint32_t i = 0; i < pinched.points.size(); ++i)
    if (pinched.points[i] == Vec3f(-0.5f)) same.push_back(i);
  REQUIRE(same.size() == 2);
  for (auto& triangle : pinched.triangles)
    std::replace(triangle.begin(), triangle.end(), same[1], same[0]);
  pinched.points[same[1]] = Vec3f(100);
  CHECK(whyNotClosed(pinched) != "");
}

TEST_CASE("grain_mesh: interfaces are shared, smoothed or not", "[grain_mesh]") {
  const LabelMap voxels = twoBalls({2, 2, 2}, 8);
  for (const int smoothing : {0, 10}) {
    const GrainMesh mesh = grainMesh(*labelGrid(voxels), {smoothing});
    REQUIRE(mesh.labels == std::vector<int32_t>{3, 7});
    CHECK(sharedTriangles(mesh, 0, 1) == 2 * contactFaces(voxels, 3, 7));
  }
}

namespace {

/// A ring of grain 1 that passes an edge of the lattice twice: on either side of it in two voxels,
/// which are joined below and above. What lies in the other two: \p one and \p other; 0: nothing.
LabelMap pinched(int32_t one, int32_t other) {
  LabelMap voxels;
  for (const int z : {-1, 1})
    for (const Coord& p : {Coord(0, 0, z), Coord(1, 0, z), Coord(1, 1, z)}) voxels[p] = 1;
  voxels[{0, 0, 0}] = voxels[{1, 1, 0}] = 1;
  if (one) voxels[{1, 0, 0}] = one;
  if (other) voxels[{0, 1, 0}] = other;
  return voxels;
}

}  // namespace

TEST_CASE("grain_mesh: an edge that a grain passes twice has two triangles each time",
          "[grain_mesh]") {
  for (const auto& [one, other] : {std::pair(0, 0), {2, 0}, {0, 2}, {2, 2}, {2, 3}})
    for (const Coord& shift : {Coord(0), Coord(7, 7, 7), Coord(-1, -1, -8)}) {
      LabelMap voxels;
      for (const auto& [p, label] : pinched(one, other)) voxels[p + shift] = label;
      checkExact(voxels);
      const GrainMesh mesh = grainMesh(*labelGrid(voxels));
      REQUIRE(mesh.triangles.size() ==
              countTriangles(*labelGrid(voxels)) + 4 + 2 * size_t(one > 0) + 2 * size_t(other > 0));
      for (size_t g = 1; g < mesh.labels.size(); ++g)
        CHECK(sharedTriangles(mesh, 0, g) ==
              2 * contactFaces(voxels, 1, mesh.labels[g]) + (one == other ? 4 : 2));
      const GrainMesh smooth = grainMesh(*labelGrid(voxels), {3});
      CHECK(whyNotClosed(smooth) == "");
      CHECK(whyNoDisc(smooth) == "");
    }
}

TEST_CASE("grain_mesh: smoothed grains stay closed and keep their volume", "[grain_mesh]") {
  std::vector<LabelMap> samples{twoBalls({0, 0, 0}, 9), awkwardLabels()};
  for (unsigned seed = 1; seed <= 6; ++seed)
    samples.push_back(
        randomLabels(seed, Coord(-9, 3, int(seed)), 12, 1 + int(seed) * 2, int(seed) * 15));
  for (const LabelMap& voxels : samples) {
    const auto volume = volumes(voxels), euler = eulerNumbers(voxels);
    for (const int smoothing : {1, 20}) {
      const GrainMesh mesh = grainMesh(*labelGrid(voxels), {smoothing});
      CHECK(whyNotClosed(mesh) == "");
      const std::vector<double> found = meshVolumes(mesh);
      for (size_t g = 0; g < found.size(); ++g) {
        CAPTURE(mesh.labels[g], smoothing);
        CHECK(found[g] == Approx(double(volume.at(mesh.labels[g]))).epsilon(0.01));
        CHECK(int64_t(mesh.firstPoint[g + 1] - mesh.firstPoint[g]) -
                  int64_t(mesh.firstTriangle[g + 1] - mesh.firstTriangle[g]) / 2 ==
              2 * euler.at(mesh.labels[g]));
      }
    }
  }
}

TEST_CASE("grain_mesh: a smoothed ball is rounder than its voxels", "[grain_mesh]") {
  LabelMap ball;
  constexpr double kRadius = 10;
  for (int x = -10; x <= 10; ++x)
    for (int y = -10; y <= 10; ++y)
      for (int z = -10; z <= 10; ++z)
        if (x * x + y * y + z * z < kRadius * kRadius) ball[{x, y, z}] = 1;
  const auto grid = labelGrid(ball);
  const auto area = [](const GrainMesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles)
      sum += 0.5 * double((mesh.points[t[1]] - mesh.points[t[0]])
                              .cross(mesh.points[t[2]] - mesh.points[t[0]])
                              .length());
    return sum;
  };
  const double sphere = 4 * M_PI * std::pow(3 * double(ball.size()) / (4 * M_PI), 2.0 / 3);
  CHECK(area(grainMesh(*grid)) > 1.4 * sphere);
  CHECK(area(grainMesh(*grid, {20})) == Approx(sphere).epsilon(0.03));
  for (const Vec3f& p : grainMesh(*grid, {20}).points)
    CHECK(double(p.length()) == Approx(kRadius).margin(0.6));
}

TEST_CASE("grain_mesh: same bits for any number of threads and with tiles", "[grain_mesh]") {
  LabelMap voxels = randomLabels(8, Coord(-20), 16, 5, 70);
  for (int x = 0; x < 24; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) voxels[{x, y, z}] = 2;
  const auto grid = labelGrid(voxels);
  const GrainMesh mesh = grainMesh(*grid, {5});
  const auto tiled = grid->deepCopy();
  tiled->pruneGrid();
  REQUIRE(tiled->tree().hasActiveTiles());
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  for (const auto& other : {grainMesh(*grid, {5}), grainMesh(*tiled, {5})}) {
    CHECK(other.labels == mesh.labels);
    CHECK(other.points == mesh.points);
    CHECK(other.triangles == mesh.triangles);
  }
}

TEST_CASE("grain_mesh: inactive and negative values are background", "[grain_mesh]") {
  const auto grid = labelGrid({{Coord(0, 0, 0), 1}, {Coord(1, 0, 0), -4}});
  grid->tree().setValueOff({0, 1, 0}, 5);
  CHECK(grainMesh(*grid).labels == std::vector<int32_t>{1});
  CHECK_THROWS_AS(grainMesh(*grid, {-1}), InvalidInput);
  CHECK_THROWS_AS(grainMesh(*grid, {1001}), InvalidInput);
}

TEST_CASE("grain_mesh: triangles are counted without meshing", "[grain_mesh]") {
  for (const LabelMap& voxels : {LabelMap(), awkwardLabels(), twoBalls({-3, 8, 5}, 6),
                                 randomLabels(3, Coord(-13), 20, 4, 60)}) {
    const auto grid = labelGrid(voxels);
    grid->tree().setValueOn({40, 0, 0}, -3);  // background
    CHECK(countTriangles(*grid) == grainMesh(*grid).triangles.size());
    CHECK(countTriangles(*grid) == grainMesh(*grid, {3}).triangles.size());
    CHECK(countTriangles(inSlabs(grid, {-24, -8, 8, 16, 32})) == countTriangles(*grid));
  }
  auto tiled = labelGrid({});
  tiled->fill(CoordBBox(Coord(0), Coord(15, 7, 7)), 5);
  REQUIRE(tiled->tree().hasActiveTiles());
  CHECK(countTriangles(*tiled) == 2 * (2 * 64 + 4 * 128));
}

TEST_CASE("grain_mesh: one grain is its part of the mesh of all", "[grain_mesh]") {
  for (const LabelMap& voxels :
       {twoBalls({3, -4, 5}, 7), awkwardLabels(), randomLabels(5, Coord(-6), 12, 4, 60)}) {
    const auto labels = labelGrid(voxels);
    const GrainMesh all = grainMesh(*labels);
    for (size_t g = 0; g < all.labels.size(); ++g) {
      CAPTURE(all.labels[g]);
      const GrainMesh one = meshOfGrains(*labels, {all.labels[g]});
      CHECK(whyNotClosed(one) == "");
      REQUIRE(one.labels == std::vector<int32_t>{all.labels[g]});
      CHECK(one.points == std::vector<Vec3f>(all.points.begin() + all.firstPoint[g],
                                             all.points.begin() + all.firstPoint[g + 1]));
      auto triangles = one.triangles;
      for (auto& triangle : triangles)
        for (uint32_t& point : triangle) point += all.firstPoint[g];
      CHECK(triangles == decltype(triangles)(all.triangles.begin() + all.firstTriangle[g],
                                             all.triangles.begin() + all.firstTriangle[g + 1]));
    }
  }
}

TEST_CASE("grain_mesh: some grains, smoothed, keep their volumes", "[grain_mesh]") {
  const LabelMap voxels = twoBalls({3, -4, 5}, 9);
  const auto labels = labelGrid(voxels);
  const GrainMesh one = meshOfGrains(*labels, {7}, {20});
  CHECK(whyNotClosed(one) == "");
  CHECK(meshVolumes(one).at(0) == Approx(double(volumes(voxels).at(7))).epsilon(0.001));
  CHECK(meshOfGrains(*labels, {7, 3}, {20}).points == grainMesh(*labels, {20}).points);
  CHECK_THROWS_AS(meshOfGrains(*labels, {4}), InvalidInput);
}
