// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <vector>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/memory_image.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/measure_necks.h"
#include "vdb_madf/scans/filtered_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("measure_necks: grains without a bond tell whether they are dark, too",
          "[measure_necks]") {
  constexpr int kCell = 28, kEdge = 3 * kCell;
  const CoordBBox box(Coord(0), Coord(kEdge - 1));
  const auto ballAt = [](const Coord& p) {
    double square = 0;
    int ball = 1, factor = 1;
    for (int axis = 0; axis < 3; ++axis) {
      square += std::pow(p[axis] % kCell - 13.5, 2);
      ball += factor * (p[axis] / kCell);
      factor *= 3;
    }
    return square < 64 ? ball : 0;
  };
  std::vector<float> values, rolled, moved;
  for (int z = 0; z < kEdge; ++z)
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        values.push_back(ballAt({x, y, z}) ? 20000 : 40000);
        rolled.push_back(ballAt({x, y, (z + 14) % kEdge}) ? 20000 : 40000);
        moved.push_back(ballAt({(x + 1) % kEdge, y, (z + 2) % kEdge}) ? 20000 : 40000);
      }
  const auto labels =
      drawLabels(box, [&](const openvdb::Vec3d& p) { return ballAt(Coord::round(p)); });
  setDomain(*labels, box);
  Measurements measured = measure(*labels);
  REQUIRE(measured.grains.size() == 27);
  REQUIRE(measured.bonds.empty());
  const ScanBlur blur{40000, 20000, 0.01, 0.8};
  const ImageSize size{kEdge, kEdge, kEdge};
  GrayScan scan{imageOf(size, values), Coord(0)}, other{imageOf(size, rolled), Coord(0)};
  measureNecks(*labels, scan, blur, measured);
  CHECK(measured.scan->inside == 20000);
  CHECK(measured.scan->outside == 40000);
  CHECK_THROWS_WITH(measureNecks(*labels, other, blur, measured),
                    vdb_madf::test::Contains("not where the labels have them"));
  GrayScan near{imageOf(size, moved), Coord(0)};
  CHECK_THROWS_WITH(measureNecks(*labels, near, blur, measured),
                    vdb_madf::test::Contains("from where the labels have them (along x, z)"));
}

TEST_CASE("measure_necks: grains that were dropped from the labels do not count",
          "[measure_necks]") {
  // Three balls, each of which touches the others: the first two by a neck of radius 6.
  constexpr double kRadius = 12, kNeck = 6;
  const double side = 2 * std::sqrt(kRadius * kRadius - kNeck * kNeck);
  const Vec3d centers[3] = {
      {16.2, 16.4, 20.1}, {16.2 + side, 16.4, 20.1}, {16.2 + side / 2, 16.4 + 0.95 * side, 20.1}};
  const CoordBBox box(Coord(0), Coord(53, 55, 40));
  const auto nearestTo = [&](const Vec3d& p) {
    int nearest = 0;
    for (int ball = 1; ball < 3; ++ball)
      if ((p - centers[ball]).lengthSqr() < (p - centers[nearest]).lengthSqr()) nearest = ball;
    return nearest;
  };
  const ImageSize size{box.dim().x(), box.dim().y(), box.dim().z()};
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        float share = 0;
        for (int i = 0; i < 64; ++i) {
          const int parts[] = {i % 4, i / 4 % 4, i / 16};
          const Vec3d p = Vec3d(x, y, z) + (Vec3d(parts[0], parts[1], parts[2]) - Vec3d(1.5)) / 4;
          share += (p - centers[nearestTo(p)]).lengthSqr() < kRadius * kRadius;
        }
        values.push_back(1000 + 2000 * share / 64);
      }
  constexpr double kBlur = 0.8;
  smoothedImage(imageOf(size, values), kBlur)->read(0, size.z, values.data());
  const ScanBlur blur{3000, 1000, 0.01, kBlur};
  const auto neckOf = [&](bool all, float threshold) {
    const auto labels = drawLabels(box, [&](const Vec3d& p) {
      const size_t at = size_t((p.z() * size.y + p.y()) * size.x + p.x());
      const int ball = values[at] < threshold ? 0 : nearestTo(p) + 1;
      return ball == 3 && !all ? 0 : ball;
    });
    setDomain(*labels, box);
    Measurements measured = measure(*labels);
    REQUIRE(measured.bonds.size() == (all ? 3 : 1));
    GrayScan scan{imageOf(size, values), Coord(0)};
    measureNecks(*labels, scan, blur, measured);
    REQUIRE(measured.bonds[0].neck);
    return *measured.bonds[0].neck;
  };
  for (const float threshold : {2000.F, 2600.F}) {
    const Neck among = neckOf(true, threshold), alone = neckOf(false, threshold);
    CHECK(among.confirmed);
    CHECK(alone.confirmed);
    CHECK(among.area == Approx(M_PI * kNeck * kNeck).epsilon(0.1));
    CHECK(alone.area == Approx(among.area).epsilon(0.08));
  }
}
