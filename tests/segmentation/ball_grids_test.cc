// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/ball_grids.h"

#include "support/catch.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;

TEST_CASE("ball_grids: the balls are read back, with the labels' transform and metadata",
          "[ball_grids]") {
  Segmentation segmentation;
  segmentation.grain = Int32Grid::create(0);
  segmentation.grain->setName("grain");
  setDomain(*segmentation.grain, CoordBBox(Coord(-9), Coord(9)));
  setVoxelSize(*segmentation.grain, VoxelSize{2e-5});
  segmentation.balls = {{Coord(-7, 0, 3), 16, 200}, {Coord(1, 2, 3), 4, 7}};
  const std::vector<Int32Grid::Ptr> made = ballGrids(segmentation);
  REQUIRE(made.size() == 2);
  const Int32Grid::Ptr radii = storedBalls({made[1], segmentation.grain, made[0]});
  REQUIRE(radii);
  CHECK(radii->getName() == "balls");
  CHECK(made[1]->getName() == "balls_cell_size");
  for (const Int32Grid::Ptr& grid : made) {
    CHECK(grid->activeVoxelCount() == 2);
    CHECK(storedDomain(*grid) == storedDomain(*segmentation.grain));
    CHECK(grid->transform() == segmentation.grain->transform());
  }
  for (const MedialBall& ball : segmentation.balls) {
    CHECK(radii->tree().getValue(ball.center) == ball.squaredRadius);
    CHECK(made[1]->tree().getValue(ball.center) == ball.cellSize);
  }
}

TEST_CASE("ball_grids: none are found where none were kept", "[ball_grids]") {
  const auto other = BoolGrid::create();
  other->setName("balls");
  CHECK_FALSE(storedBalls({other}));
  CHECK_FALSE(storedBalls({}));
}

TEST_CASE("ball_grids: balls are of the object that their counts tell", "[ball_grids]") {
  const auto balls = Int32Grid::create(0), labels = Int32Grid::create(0);
  CHECK(areBallsOfObject(*balls, *labels));
  balls->insertMeta("madf_object_voxels", openvdb::Int64Metadata(7));
  CHECK(areBallsOfObject(*balls, *labels));
  labels->insertMeta("madf_object_voxels", openvdb::Int64Metadata(7));
  CHECK(areBallsOfObject(*balls, *labels));
  labels->insertMeta("madf_object_voxels", openvdb::Int64Metadata(6));
  CHECK_FALSE(areBallsOfObject(*balls, *labels));
}
