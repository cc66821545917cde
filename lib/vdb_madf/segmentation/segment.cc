// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/method/cavities.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/gamma_filter.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/detail/segment_options.h"
#include "vdb_madf/segmentation/detail/stages.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segment_memory.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

void checkMemory(const ObjectSize& size, const SegmentOptions& options) {
  if (options.maxMemory == 0) return;
  const int64_t needed = segmentMemory(size, options);
  if (needed <= options.maxMemory) return;
  throw InvalidInput("segmenting needs about " + readableBytes(needed) + " of memory, and " +
                         readableBytes(options.maxMemory) +
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

/// What the method runs on: the object with its cavities filled.
struct Body {
  LeafIndex index;
  std::vector<VoxelId> cavities;  ///< voxels that are none of the object, ascending
};

Body fillCavities(LeafIndex object, const Cavities& cavities) {
  if (cavities.count == 0) return {std::move(object), {}};
  Body body{LeafIndex(object, cavities.leaves), {}};
  body.cavities = cavityVoxels(body.index, cavities);
  return body;
}

/// Critical points count the voxels of the object alone.
void uncountCavities(const Body& body, Flow& flow) {
  for (const VoxelId id : body.cavities)
    --flow.criticalPoints[(flow.manifold[body.index.rank(id)] & ~Flow::kOwnCell) - 1].voxels;
}

/// A grid on the object.
template <typename Values>
Int32Grid::Ptr toObjectGrid(const Body& body, Values&& values, const char* name,
                            Interrupter* interrupter) {
  const auto grid = toGrid(body.index, std::forward<Values>(values), name, interrupter);
  removeVoxels(*grid, body.index, body.cavities);
  return grid;
}

/// Grain labels from the manifolds, which they replace.
GrainLabels labelGrains(const Body& body, VoxelArray<uint32_t> manifold, const ManifoldGraph& graph,
                        const Merging& merging, Interrupter* interrupter) {
  GrainLabels grains = detail::grainsOf(graph, merging);
  grains.label = std::move(manifold);
  detail::parallelFor(grains.label.size(), size_t(1) << 16, interrupter,
                      [&](size_t begin, size_t end) {
                        for (size_t i = begin; i < end; ++i) {
                          const uint32_t node = (grains.label[i] & ~Flow::kOwnCell) - 1;
                          grains.label[i] = uint32_t(merging.grainOfNode[node]);
                        }
                      });
  for (const VoxelId id : body.cavities) grains.label[body.index.rank(id)] = 0;
  return grains;
}

std::vector<std::string> omittedStages(const SegmentOptions& options, int64_t fillHoles) {
  std::vector<std::string> omitted;
  if (fillHoles <= 1) omitted.push_back("cavities");
  if (options.gamma <= 1) omitted.push_back("gamma_filter");
  return omitted;
}

}  // namespace

void detail::checkSegmentOptions(const SegmentOptions& options) {
  if (options.gamma < 0) throw InvalidInput("gamma is a number of voxels: it must not be negative");
  if (options.fillHoles.value_or(0) < 0)
    throw InvalidInput("cavities are filled below a number of voxels: it must not be negative");
  checkTidy(options.tidy);
  checkMergeOptions(options.merge);
}

WeightsOfEdges detail::resolveWeights(const std::optional<VoxelWeights>& weights,
                                      const std::array<double, 3>& edges, const Coord& extent) {
  if (!weights) return weightsOfEdges(edges, extent);
  checkWeights(*weights, extent);
  return {*weights, 0};
}

Segmentation segment(const MaskGrid& object, const SegmentOptions& options,
                     Interrupter* interrupter) {
  detail::checkSegmentOptions(options);
  Segmentation result;
  SegmentCounts& counts = result.counts;
  const bool filter = options.gamma > 1;
  const std::array<double, 3> edges =
      options.weights ? std::array<double, 3>{1, 1, 1} : voxelEdges(object.transform());
  ObjectSize size;
  if (options.maxMemory > 0) size = objectSize(object);
  checkMemory(size, options);
  result.domain = options.domain ? options.domain : storedDomain(object);
  result.fillHoles = options.fillHoles.value_or(defaultFillHoles(result.domain));
  result.tidy = options.tidy;
  detail::Stages stages(interrupter, omittedStages(options, result.fillHoles), result.times);

  stages.begin("leaf_index");
  LeafIndex objectIndex(object);
  const Obstacles obstacles = resolveBoundary(objectIndex, options.boundary, result.domain);
  result.open = obstacles.open;
  counts.objectVoxels = objectIndex.voxelCount();
  counts.leaves = int64_t(objectIndex.leafCount());

  Cavities cavities;
  if (result.fillHoles > 1) {
    stages.begin("cavities");
    cavities = findCavities(objectIndex, result.domain, result.open, result.fillHoles, &stages);
    counts.cavities = cavities.count;
    counts.cavityVoxels = cavities.voxels;
  }
  const Body body = fillCavities(std::move(objectIndex), cavities);
  const LeafIndex& index = body.index;
  checkMemory({int64_t(index.leafCount()), index.voxelCount(), size.thin}, options);
  // Across a region the nearest background may lie anywhere.
  const bool inRegion = obstacles.open && !obstacles.domain.isBox();
  const CoordBBox& extent = inRegion ? obstacles.domain.box() : index.boundingBox();
  const WeightsOfEdges weights = detail::resolveWeights(options.weights, edges, extent.dim());
  result.weights = weights.weights;
  result.weightsError = weights.error;

  stages.begin("squared_distance");
  SquaredDistance distance = squaredDistance(index, obstacles, result.weights, &stages);
  counts.largestSquaredDistance = distance.largest;
  if (options.keepDistance)
    result.distanceSquared = toObjectGrid(body, distance.values, "distance_squared", &stages);

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
    VoxelSet kept = keptBalls(index, map, balls, table, options.gamma, &stages);
    counts.keptBalls = kept.size();
    map = filteredPowerMap(index, std::move(map), balls, table, kept, &stages);
    balls = std::move(kept);
    table = {};
  }

  stages.begin("flow");
  Flow flowMap = flow(index, std::move(map.site), map.power, balls, &stages);
  counts.criticalPoints = int64_t(flowMap.criticalPoints.size());
  uncountCavities(body, flowMap);

  stages.begin("manifold_graph");
  result.graph = manifoldGraph(index, flowMap, map.power, &stages);
  result.graph.weights = result.weights;
  if (options.keepPower) result.power = toObjectGrid(body, map.power, "power", &stages);
  if (options.keepManifold)
    result.manifold = toObjectGrid(body, flowMap.manifold, "manifold", &stages);
  map.power.clear();

  stages.begin("merge");
  const Merging merging = merge(result.graph, options.merge);
  counts.grains = int64_t(merging.representative.size());

  stages.begin("tidy");
  GrainLabels grains =
      labelGrains(body, std::move(flowMap.manifold), result.graph, merging, &stages);
  result.flaws = detail::tidyAndCountFlaws(index, options.tidy, result.domain, grains, &stages);
  result.grainVoxels = std::move(grains.voxels);

  stages.begin("labels");
  result.grain = toObjectGrid(body, std::move(grains.label), "grain", &stages);
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
