// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "support/mesh_checks.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/shapes/grain_mesh.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::Vec3d;
using openvdb::Vec3f;

namespace {

constexpr int kSide = 40;
const Coord kLow(-7, 3, 11);
const CoordBBox kBox(kLow, kLow.offsetBy(kSide - 1));

/// The nearest of some random centers, in all of a box: faces, lines and corners of all kinds, and
/// no background. Voxels farther than \p most from their center are left out.
LabelMap cells(unsigned seed, int count, double most = 1e9) {
  std::mt19937 random(seed);
  std::vector<Coord> centers;
  for (int n = 0; n < count; ++n)
    centers.push_back(
        kLow.offsetBy(int(random() % kSide), int(random() % kSide), int(random() % kSide)));
  LabelMap voxels;
  for (auto p = kBox.begin(); p; ++p) {
    std::pair<int, int> nearest{1 << 30, 0};
    for (int n = 0; n < count; ++n) {
      const Coord d = *p - centers[size_t(n)];
      nearest = std::min(nearest, {d.x() * d.x() + d.y() * d.y() + d.z() * d.z(), n + 1});
    }
    if (nearest.first <= most * most) voxels[*p] = nearest.second;
  }
  return voxels;
}

Int32Grid::Ptr inBox(const LabelMap& voxels) {
  const auto grid = labelGrid(voxels);
  setDomain(*grid, kBox);
  return grid;
}

using Place = Corners::value_type;

/// Triangles without another one turned over: those towards the background, if all is shared.
std::vector<Corners> freeTriangles(const GrainMesh& mesh) {
  std::multiset<Corners> all;
  for (const auto& triangle : mesh.triangles) all.insert(cornersOf(mesh, triangle, false));
  std::vector<Corners> result;
  for (const auto& triangle : mesh.triangles)
    if (!all.count(cornersOf(mesh, triangle, true)))
      result.push_back(cornersOf(mesh, triangle, false));
  return result;
}

/// The box's face that a triangle lies on, 0 to 5; -1 if on none.
int faceOf(const Corners& corners) {
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const float plane = side ? float(kBox.max()[axis]) + 0.5f : float(kBox.min()[axis]) - 0.5f;
      if (std::all_of(corners.begin(), corners.end(),
                      [&](const Place& p) { return p[size_t(axis)] == plane; }))
        return 2 * axis + side;
    }
  return -1;
}

double areaOf(const Corners& corners) {
  const auto at = [&](size_t n) { return Vec3d(corners[n][0], corners[n][1], corners[n][2]); };
  return (at(1) - at(0)).cross(at(2) - at(0)).length() / 2;
}

/// By tetrahedra with a point far from the grain's.
std::map<int32_t, double> volumesOf(const GrainMesh& mesh) {
  std::map<int32_t, double> result;
  for (size_t g = 0; g < mesh.labels.size(); ++g)
    for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3d apex(-50, 20, 7);
      result[mesh.labels[g]] +=
          (Vec3d(mesh.points[a]) - apex)
              .dot((Vec3d(mesh.points[b]) - apex).cross(Vec3d(mesh.points[c]) - apex)) /
          6;
    }
  return result;
}

GrainMesh simplified(const Int32Grid& labels, int smoothing, uint64_t triangles) {
  GrainMeshOptions options;
  options.smoothing = smoothing;
  options.triangles = triangles;
  return grainMesh(labels, options);
}

std::vector<int64_t> eulerNumbersOf(const GrainMesh& mesh) {
  std::vector<int64_t> result;
  for (size_t g = 0; g < mesh.labels.size(); ++g)
    result.push_back(int64_t(mesh.firstPoint[g + 1] - mesh.firstPoint[g]) -
                     int64_t(mesh.firstTriangle[g + 1] - mesh.firstTriangle[g]) / 2);
  return result;
}

}  // namespace

TEST_CASE(
    "simplified_mesh: cells that fill a box stay closed, shared, flat at its faces, and as large",
    "[simplified_mesh]") {
  const LabelMap voxels = cells(3, 24);
  const auto grid = inBox(voxels);
  const auto volume = volumes(voxels);
  for (const int smoothing : {0, 10}) {
    const GrainMesh all = simplified(*grid, smoothing, 0);
    for (const double part : {1.0, 0.25, 0.05}) {
      const auto budget = uint64_t(part * double(all.triangles.size()));
      const GrainMesh mesh = simplified(*grid, smoothing, budget);
      CAPTURE(smoothing, part, all.triangles.size());
      CHECK(mesh.labels == all.labels);
      CHECK(mesh.triangles.size() <= budget);
      CHECK(mesh.triangles.size() + 20 > budget);
      CHECK(whyNotClosed(mesh) == "");
      CHECK(whyNoDisc(mesh) == "");
      CHECK(eulerNumbersOf(mesh) == eulerNumbersOf(all));
      for (const auto& [label, found] : volumesOf(mesh))
        CHECK(found == Approx(double(volume.at(label))).epsilon(0.002));
      std::array<double, 6> areas{};
      for (const Corners& corners : freeTriangles(mesh)) {
        REQUIRE(faceOf(corners) >= 0);
        areas[size_t(faceOf(corners))] += areaOf(corners);
      }
      for (const double area : areas) CHECK(area == Approx(kSide * kSide).epsilon(1e-6));
    }
  }
}

TEST_CASE("simplified_mesh: the least number of triangles keeps every grain and contact",
          "[simplified_mesh]") {
  const LabelMap voxels = cells(5, 60, 9);
  const auto grid = inBox(voxels);
  const GrainMesh all = simplified(*grid, 10, 0), least = simplified(*grid, 10, 1);
  CHECK(least.triangles.size() < all.triangles.size() / 20);
  CHECK(least.labels == all.labels);
  CHECK(whyNotClosed(least) == "");
  CHECK(whyNoDisc(least) == "");
  CHECK(eulerNumbersOf(least) == eulerNumbersOf(all));
  // Grains that share triangles are those whose voxels have faces in common.
  const auto contactsOf = [](const GrainMesh& mesh) {
    std::map<Corners, int32_t> owner;
    std::set<std::pair<int32_t, int32_t>> contacts;
    for (size_t g = 0; g < mesh.labels.size(); ++g)
      for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t)
        owner[cornersOf(mesh, mesh.triangles[t], false)] = mesh.labels[g];
    for (size_t g = 0; g < mesh.labels.size(); ++g)
      for (uint32_t t = mesh.firstTriangle[g]; t < mesh.firstTriangle[g + 1]; ++t) {
        const auto other = owner.find(cornersOf(mesh, mesh.triangles[t], true));
        if (other != owner.end() && other->second != mesh.labels[g])
          contacts.emplace(mesh.labels[g], other->second);
      }
    return contacts;
  };
  std::set<std::pair<int32_t, int32_t>> contacts;
  for (const auto& [p, label] : voxels)
    for (const Coord& step : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)}) {
      const auto other = voxels.find(p + step);
      if (other == voxels.end() || other->second == label) continue;
      contacts.emplace(label, other->second);
      contacts.emplace(other->second, label);
    }
  CHECK((contactsOf(least) == contacts));
}

TEST_CASE("simplified_mesh: crumbs and awkward grains stay closed", "[simplified_mesh]") {
  std::vector<LabelMap> samples{awkwardLabels(), twoBalls({3, -4, 5}, 7), {{Coord(7, -8, 15), 9}}};
  for (unsigned seed = 1; seed <= 8; ++seed)
    samples.push_back(
        randomLabels(seed, Coord(-5, 3, int(seed)), 12, 1 + int(seed % 3), 25 + 6 * int(seed)));
  for (const LabelMap& voxels : samples)
    for (const int smoothing : {0, 5}) {
      const auto grid = labelGrid(voxels);
      const GrainMesh all = simplified(*grid, smoothing, 0);
      for (const uint64_t budget : {all.triangles.size() / 2, size_t(1)}) {
        const GrainMesh mesh = simplified(*grid, smoothing, budget);
        CHECK(mesh.labels == all.labels);
        CHECK(whyNotClosed(mesh) == "");
        CHECK(whyNoDisc(mesh) == "");
        CHECK(eulerNumbersOf(mesh) == eulerNumbersOf(all));
      }
    }
}

TEST_CASE("simplified_mesh: without error the faces of a box of voxels are two triangles each",
          "[simplified_mesh]") {
  LabelMap voxels;
  for (auto p = CoordBBox(Coord(-9, 4, 6), Coord(3, 11, 30)).begin(); p; ++p)
    voxels[*p] = (*p).x() < -2 ? 4 : 9;
  GrainMeshOptions options;
  options.triangles = 1;
  options.error = 0;
  const GrainMesh mesh = grainMesh(*labelGrid(voxels), options);
  CHECK(mesh.triangles.size() == 24);
  CHECK(whyNotClosed(mesh) == "");
  for (const auto& [label, volume] : volumesOf(mesh))
    CHECK(volume == Approx(volumes(voxels).at(label)));
  CHECK(freeTriangles(mesh).size() == 20);
}

TEST_CASE("simplified_mesh: the error bounds how far a ball's surface moves", "[simplified_mesh]") {
  LabelMap ball;
  constexpr int kRadius = 16;
  for (auto p = CoordBBox(Coord(-kRadius), Coord(kRadius)).begin(); p; ++p)
    if ((*p).asVec3d().lengthSqr() < kRadius * kRadius) ball[*p] = 1;
  const auto grid = labelGrid(ball);
  size_t last = grainMesh(*grid, {20}).triangles.size();
  for (const double error : {0.05, 0.2, 0.8}) {
    GrainMeshOptions options;
    options.smoothing = 20;
    options.triangles = 1;
    options.error = error;
    const GrainMesh mesh = grainMesh(*grid, options);
    CAPTURE(error, mesh.triangles.size());
    CHECK(mesh.triangles.size() < last);
    last = mesh.triangles.size();
    for (const Vec3f& p : mesh.points)
      CHECK(double(p.length()) == Approx(kRadius).margin(0.6 + 1.5 * error));
  }
}

TEST_CASE("simplified_mesh: same bits for any number of threads", "[simplified_mesh]") {
  const auto grid = inBox(cells(8, 40, 12));
  const GrainMesh mesh = simplified(*grid, 5, 3000);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const GrainMesh other = simplified(*grid, 5, 3000);
  CHECK(other.labels == mesh.labels);
  CHECK(other.points == mesh.points);
  CHECK(other.triangles == mesh.triangles);
  CHECK(other.firstTriangle == mesh.firstTriangle);
}

TEST_CASE("simplified_mesh: no grain, bad options", "[simplified_mesh]") {
  CHECK(simplified(*labelGrid({}), 3, 7).triangles.empty());
  GrainMeshOptions options;
  options.triangles = 100;
  for (const double error : {-1.0, std::nan("")}) {
    options.error = error;
    CHECK_THROWS_AS(grainMesh(*labelGrid({{Coord(0), 1}}), options), InvalidInput);
  }
}
