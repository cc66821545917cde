// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segment.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "vdb_madf/errors.h"
#include "vdb_madf/flow.h"
#include "vdb_madf/gamma_filter.h"
#include "vdb_madf/graph_metadata.h"
#include "vdb_madf/grid_metadata.h"
#include "vdb_madf/leaf_index.h"
#include "vdb_madf/medial_balls.h"
#include "vdb_madf/power_map.h"
#include "vdb_madf/segmentation_metadata.h"

namespace vdb_madf {

namespace {

/// Tells the interrupter what is going on and keeps the time of each stage.
class Stages {
 public:
  Stages(Interrupter* interrupter, std::vector<StageTime>& times)
      : interrupter_(interrupter), times_(times) {}
  ~Stages() { end(); }
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  void begin(const char* stage) {
    end();
    times_.push_back({stage, 0});
    begin_ = Clock::now();
    running_ = true;
    if (!interrupter_) return;
    interrupter_->start(stage);
    if (interrupter_->wasInterrupted(0)) throw Interrupted();
  }
  void end() {
    if (!running_) return;
    times_.back().seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    if (interrupter_) interrupter_->end();
    running_ = false;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Interrupter* interrupter_;
  std::vector<StageTime>& times_;
  Clock::time_point begin_;
  bool running_ = false;
};

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
  Stages stages(interrupter, result.times);
  result.domain = options.domain ? options.domain : domain(object);

  stages.begin("leaf_index");
  const LeafIndex index(object);
  const Obstacles obstacles = resolveBoundary(index, options.boundary, result.domain);
  result.open = obstacles.open;
  counts.objectVoxels = index.voxelCount();
  counts.leaves = int64_t(index.leafCount());

  stages.begin("squared_distance");
  SquaredDistance distance = squaredDistance(index, obstacles, interrupter);
  counts.largestSquaredDistance = distance.largest;
  if (options.keepDistance)
    result.distanceSquared = toGrid(index, distance.values, "distance_squared", interrupter);

  stages.begin("power_map");
  PowerMap map = powerMap(index, std::move(distance), interrupter);

  stages.begin("medial_balls");
  VoxelSet balls = medialBalls(index, map, interrupter);
  const bool filter = options.gamma > 1;
  MedialBallTable table;
  if (filter || options.keepBalls) table = measureBalls(index, map, balls, interrupter);
  if (options.keepBalls) result.balls = listBalls(index, balls, table);
  counts.medialBalls = counts.keptBalls = balls.size();

  if (filter) {
    stages.begin("gamma_filter");
    VoxelSet kept = keptBalls(index, balls, table, options.gamma);
    counts.keptBalls = kept.size();
    map = filteredPowerMap(index, std::move(map), balls, table, kept, interrupter);
    balls = std::move(kept);
    table = {};
  }

  stages.begin("flow");
  Flow flowMap = flow(index, std::move(map.site), map.power, balls, interrupter);
  counts.criticalPoints = int64_t(flowMap.criticalPoints.size());

  stages.begin("manifold_graph");
  result.graph = manifoldGraph(index, flowMap, map.power, interrupter);
  if (options.keepPower) result.power = toGrid(index, map.power, "power", interrupter);
  map.power.clear();

  stages.begin("merge");
  const Merging merging = merge(result.graph, options.merge);
  counts.grains = int64_t(merging.representative.size());
  result.grainVoxels.assign(merging.representative.size(), 0);
  for (size_t i = 0; i < result.graph.nodes.size(); ++i)
    result.grainVoxels[size_t(merging.grainOfNode[i] - 1)] += result.graph.nodes[i].voxels;

  stages.begin("labels");
  if (options.keepManifold)
    result.manifold = toGrid(index, flowMap.manifold, identity(result.graph.nodes.size() + 1),
                             "manifold", interrupter);
  result.grain =
      toGrid(index, std::move(flowMap.manifold), labelTable(merging), "grain", interrupter);
  for (const Int32Grid::Ptr& grid :
       {result.grain, result.distanceSquared, result.power, result.manifold}) {
    if (!grid) continue;
    copyProvenance(object, *grid);
    if (result.domain) setDomain(*grid, *result.domain);
    describeSegmentation(*grid, options, result);
  }
  if (result.manifold) setGraph(*result.manifold, result.graph);
  return result;
}

}  // namespace vdb_madf
