// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <vector>

#include "support/catch.h"
#include "support/known_bodies.h"
#include "support/memory_image.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/intensity/measure_necks.h"

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
