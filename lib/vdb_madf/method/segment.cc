// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/segment.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/detail/stages.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/gamma_filter.h"
#include "vdb_madf/method/graph_metadata.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/method/segment_memory.h"
#include "vdb_madf/method/segmentation_metadata.h"

namespace vdb_madf {

namespace {

void checkMemory(const MaskGrid& object, const SegmentOptions& options) {
  if (options.maxMemory == 0) return;
  const int64_t needed = segmentMemory(objectSize(object), options);
  if (needed <= options.maxMemory) return;
  throw InvalidInput("segmenting needs about " + std::to_string(needed) + " bytes of memory, and " +
                         std::to_string(options.maxMemory) +
                         " may be used: crop or coarsen the volume, or allow more",
                     Hint::memoryLimit);
}

std::vector<MedialBall> listBalls(const LeafIndex& index, const VoxelSet& balls,
                                  const MedialBallTable& table) {
  std::vector<MedialBall> list;
  list.reserve(balls.size());
  for (const VoxelId id : balls.members())
    list.push_back(
        {index.coord(id), table.squaredRadius[list.size()], int64_t(table.cellSize[list.size()])});
  std::sort(list.begin(), list.end(),
            [](const MedialBall& a, const MedialBall& b) { return a.center < b.center; });
  return list;
}

std::vector<int32_t> identity(size_t count) {
  std::vector<int32_t> table(count);
  for (size_t i = 0; i < count; ++i) table[i] = int32_t(i);
  return table;
}

/// Grain label by manifold number; 0 outside the object.
std::vector<int32_t> labelTable(const Merging& merging) {
  std::vector<int32_t> table(1, 0);
  table.insert(table.end(), merging.grainOfNode.begin(), merging.grainOfNode.end());
  return table;
}

}  // namespace

Segmentation segment(const MaskGrid& object, const SegmentOptions& options,
                     Interrupter* interrupter) {
  if (options.gamma < 0) throw InvalidInput("gamma is a number of voxels: it must not be negative");
  checkMergeOptions(options.merge);

  Segmentation result;
  SegmentCounts& counts = result.counts;
  const bool filter = options.gamma > 1;
  checkMemory(object, options);
  detail::Stages stages(interrupter, filter, result.times);
  result.domain = options.domain ? options.domain : storedDomain(object);

  stages.begin("leaf_index");
  const LeafIndex index(object);
  const Obstacles obstacles = resolveBoundary(index, options.boundary, result.domain);
  result.open = obstacles.open;
  counts.objectVoxels = index.voxelCount();
  counts.leaves = int64_t(index.leafCount());

  stages.begin("squared_distance");
  SquaredDistance distance = squaredDistance(index, obstacles, &stages);
  counts.largestSquaredDistance = distance.largest;
  if (options.keepDistance)
    result.distanceSquared = toGrid(index, distance.values, "distance_squared", &stages);

  stages.begin("power_map");
  PowerMap map = powerMap(index, std::move(distance), &stages);

  stages.begin("medial_balls");
  VoxelSet balls = medialBalls(index, map, &stages);
  MedialBallTable table;
  if (filter || options.keepBalls) table = measureBalls(index, map, balls, &stages);
  if (options.keepBalls) result.balls = listBalls(index, balls, table);
  counts.medialBalls = counts.keptBalls = balls.size();

  if (filter) {
    stages.begin("gamma_filter");
    VoxelSet kept = keptBalls(index, balls, table, options.gamma, &stages);
    counts.keptBalls = kept.size();
    map = filteredPowerMap(index, std::move(map), balls, table, kept, &stages);
    balls = std::move(kept);
    table = {};
  }

  stages.begin("flow");
  Flow flowMap = flow(index, std::move(map.site), map.power, balls, &stages);
  counts.criticalPoints = int64_t(flowMap.criticalPoints.size());

  stages.begin("manifold_graph");
  result.graph = manifoldGraph(index, flowMap, map.power, &stages);
  if (options.keepPower) result.power = toGrid(index, map.power, "power", &stages);
  map.power.clear();

  stages.begin("merge");
  const Merging merging = merge(result.graph, options.merge);
  counts.grains = int64_t(merging.representative.size());
  result.grainVoxels = grainVoxels(result.graph, merging);

  stages.begin("labels");
  if (options.keepManifold)
    result.manifold = toGrid(index, flowMap.manifold, identity(result.graph.nodes.size() + 1),
                             "manifold", &stages);
  result.grain = toGrid(index, std::move(flowMap.manifold), labelTable(merging), "grain", &stages);
  for (const Int32Grid::Ptr& grid :
       {result.grain, result.distanceSquared, result.power, result.manifold}) {
    if (!grid) continue;
    copyProvenance(object, *grid);
    if (result.domain) setDomain(*grid, *result.domain);
    describeSegmentation(*grid, options, result);
  }
  if (result.manifold) setGraph(*result.manifold, result.graph);
  stages.finish();
  return result;
}

}  // namespace vdb_madf
