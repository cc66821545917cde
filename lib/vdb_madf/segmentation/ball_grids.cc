// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/ball_grids.h"

#include <string>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

constexpr const char *kSquaredRadius = "balls", *kCellSize = "balls_cell_size";

Int32Grid::Ptr emptyGrid(const char* name, const Int32Grid& labels) {
  const auto grid = Int32Grid::create(0);
  copyMetadata(labels, *grid);
  grid->setName(name);
  return grid;
}

}  // namespace

std::vector<Int32Grid::Ptr> ballGrids(const Segmentation& segmentation) {
  const Int32Grid::Ptr radius = emptyGrid(kSquaredRadius, *segmentation.grain);
  const Int32Grid::Ptr cellSize = emptyGrid(kCellSize, *segmentation.grain);
  auto radii = radius->getAccessor(), cellSizes = cellSize->getAccessor();
  for (const MedialBall& ball : segmentation.balls) {
    radii.setValueOn(ball.center, ball.squaredRadius);
    cellSizes.setValueOn(ball.center, int32_t(ball.cellSize));
  }
  return {radius, cellSize};
}

Int32Grid::Ptr closedBalls(const MaskGrid& object, int64_t maxMemory, Interrupter* interrupter) {
  SegmentOptions options;
  options.boundary = Boundary::closed;
  options.keepBalls = true;
  options.maxMemory = maxMemory;
  return ballGrids(segment(object, options, interrupter)).front();
}

Int32Grid::Ptr storedBalls(const std::vector<openvdb::GridBase::Ptr>& grids) {
  for (const auto& grid : grids)
    if (grid->getName() == kSquaredRadius && grid->isType<Int32Grid>())
      return openvdb::gridPtrCast<Int32Grid>(grid);
  return nullptr;
}

bool areBallsOfObject(const Int32Grid& balls, const Int32Grid& labels) {
  const auto ofBalls = objectVoxelCount(balls), ofLabels = objectVoxelCount(labels);
  return !ofBalls || !ofLabels || *ofBalls == *ofLabels;
}

}  // namespace vdb_madf
