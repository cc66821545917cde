// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/select_grains.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("select_grains: the voxels of some labels, and no others", "[select_grains]") {
  const LabelMap voxels = randomLabels(3, Coord(-6, 20, -9), 19, 6, 60);
  const auto labels = labelGrid(voxels);
  setVoxelSize(*labels, VoxelSize{1e-5});
  setDomain(*labels, CoordBBox(Coord(-20), Coord(50)));
  for (const std::vector<int32_t>& grains :
       std::vector<std::vector<int32_t>>{{4}, {6, 1, 6}, {1, 2, 3, 4, 5, 6}, {}}) {
    CAPTURE(grains);
    LabelMap expected;
    for (const auto& [p, label] : voxels)
      if (std::count(grains.begin(), grains.end(), label)) expected[p] = label;
    const auto selected = selectGrains(*labels, grains);
    CHECK(selected->activeVoxelCount() == expected.size());
    for (const auto& [p, label] : expected) REQUIRE(selected->tree().getValue(p) == label);
    CHECK(selected->getName() == "grain");
    CHECK(selected->transform() == labels->transform());
    CHECK(storedDomain(*selected) == storedDomain(*labels));
  }
  CHECK(labels->activeVoxelCount() == voxels.size());
}

TEST_CASE("select_grains: tiles", "[select_grains]") {
  const auto labels = labelGrid({{{-1, 0, 0}, 5}, {{-2, 0, 0}, 6}});
  labels->fill(CoordBBox(Coord(0), Coord(127)), 5);
  labels->fill(CoordBBox(Coord(128, 0, 0), Coord(135, 7, 7)), 6);
  REQUIRE(labels->tree().activeTileCount() > 0);
  CHECK(selectGrains(*labels, {5})->activeVoxelCount() == 1 + 128 * 128 * 128);
  const auto small = selectGrains(*labels, {6});
  CHECK(small->activeVoxelCount() == 1 + 512);
  CHECK(small->tree().getValue(Coord(-2, 0, 0)) == 6);
  CHECK(small->tree().getValue(Coord(-1, 0, 0)) == 0);
}

TEST_CASE("select_grains: what is not there is refused", "[select_grains]") {
  const auto labels = labelGrid(twoBalls({0, 0, 0}, 4));  // 3 and 7
  CHECK_THROWS_WITH(selectGrains(*labels, {3, 5}), "there is no grain 5");
  for (const int32_t label : {0, -1}) CHECK_THROWS_AS(selectGrains(*labels, {label}), InvalidInput);
  // Inactive voxels are no grain's.
  labels->tree().setValueOff(Coord(100, 0, 0), 9);
  CHECK_THROWS_AS(selectGrains(*labels, {9}), InvalidInput);
}
