// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_masks.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_name.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("grain_masks: the voxels of each label", "[grain_masks]") {
  for (const LabelMap& voxels :
       {twoBalls({5, -6, 7}, 6), awkwardLabels(), randomLabels(5, Coord(-6), 17, 8, 40)}) {
    const auto labels = labelGrid(voxels);
    setVoxelSize(*labels, VoxelSize{1e-5});
    const auto grids = grainMasks(*labels);
    const auto sizes = volumes(voxels);
    REQUIRE(grids.size() == sizes.size());
    size_t n = 0;
    for (const auto& [label, size] : sizes) {  // ascending
      char name[24];
      std::snprintf(name, sizeof name, "grain_%06d", int(label));
      const BoolGrid& grid = *grids[n++];
      CHECK(grid.getName() == name);
      CHECK(grid.transform() == labels->transform());
      CHECK(!grid.background());
      CHECK(grid.activeVoxelCount() == openvdb::Index64(size));
      for (const auto& [p, own] : voxels) {
        CHECK(grid.tree().isValueOn(p) == (own == label));
        CHECK(grid.tree().getValue(p) == (own == label));
      }
    }
  }
}

TEST_CASE("grain_masks: tiles, empty, limit", "[grain_masks]") {
  const auto tile = Int32Grid::create(0);
  tile->fill(CoordBBox(Coord(0), Coord(127)), 5);
  REQUIRE(tile->tree().activeTileCount() > 0);
  CHECK(grainMasks(*tile).at(0)->activeVoxelCount() == 128 * 128 * 128);
  CHECK(grainMasks(*labelGrid({})).empty());
  LabelMap many;
  for (int i = 0; i <= int(kMaxGrainGrids); ++i) many[{i, 0, 0}] = i + 1;
  CHECK_THROWS_AS(grainMasks(*labelGrid(many)), InvalidInput);
}
