// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/level_sets.h"

#include <catch2/catch.hpp>

#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_name.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

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
      // A voxel's centre is half a voxel from its faces, or farther.
      wrong += inside ? value > -0.49 * kEdge : value < 0.49 * kEdge;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("level_sets: limits", "[level_sets]") {
  LabelMap many;
  for (int i = 0; i <= int(kMaxGrainGrids); ++i) many[{i, 0, 0}] = i + 1;
  CHECK_THROWS_AS(grainLevelSets(*labelGrid(many)), InvalidInput);
  CHECK(grainLevelSets(*labelGrid({})).empty());
  CHECK_THROWS_AS(surfaceLevelSet(*labelGrid({})), InvalidInput);
  CHECK_THROWS_AS(surfaceLevelSet(*labelGrid({{Coord(0), 1}}), {0, 0.5f}), InvalidInput);
}
