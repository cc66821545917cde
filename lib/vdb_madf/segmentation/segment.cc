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
#include "vdb_madf/method/cavities.h"
#include "vdb_madf/method/flow.h"
#include "vdb_madf/method/gamma_filter.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/method/power_map.h"
#include "vdb_madf/segmentation/detail/grain_flags.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/detail/prepare.h"
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

std::vector<std::string> omittedStages(const SegmentOptions& options, int64_t fillHoles) {
  std::vector<std::string> omitted;
  if (fillHoles <= 1) omitted.push_back("cavities");
  if (options.gamma <= 1) omitted.push_back("gamma_filter");
  return omitted;
}

class Segmenter {
 public:
  Segmenter(const MaskGrid& object, const SegmentOptions& options, Interrupter* interrupter)
      : object_(object),
        options_(options),
        obstacles_(detail::prepare(object, options, result_)),
        stages_(interrupter, omittedStages(options, result_.fillHoles), result_.times) {}

  Segmentation run() {
    fillCavities();
    SquaredDistance distance = measureDistance();
    PowerMap map = powerMap(index_, std::move(distance), stages_.begin("power_map"));
    const VoxelSet balls = chooseBalls(map);
    Flow flowMap = followFlow(map, balls);
    linkManifolds(flowMap, map);
    map = {};
    flowMap.criticalPoints = {};  // the graph has them
    stages_.begin("merge");
    if (options_.autoStrictness) {
      result_.stable = stableStrictness(mergeHierarchy(result_.graph));
      options_.merge.strictness = result_.stable->strictness;
    }
    const Merging merging = merge(result_.graph, options_.merge);
    counts_.grains = int64_t(merging.representative.size());
    stages_.begin("tidy");
    GrainLabels grains = labelGrains(std::move(flowMap.manifold), merging);
    result_.flaws =
        detail::tidyAndCountFlaws(index_, options_.tidy, result_.domain, grains, &stages_);
    finish(std::move(grains));
    return std::move(result_);
  }

 private:
  /// What the method runs on is the body: the object with its cavities filled.
  void fillCavities() {
    if (options_.maxMemory > 0) {
      size_ = sizeAtMost(object_, options_);
      if (segmentMemory(size_, options_) > options_.maxMemory)
        size_ = sampledSize(object_, options_);
    }
    checkMemory(size_, options_);
    stages_.begin("leaf_index");
    index_ = LeafIndex(object_);
    resolveBoundary(index_, options_.boundary, result_.domain);  // is all of it inside?
    counts_.objectVoxels = index_.voxelCount();
    counts_.leaves = int64_t(index_.leafCount());
    if (result_.fillHoles > 1) {
      const Cavities cavities = findCavities(index_, result_.domain, result_.open,
                                             result_.fillHoles, stages_.begin("cavities"));
      counts_.cavities = cavities.count;
      counts_.cavityVoxels = cavities.voxels;
      if (cavities.count > 0) index_ = LeafIndex(index_, cavities.leaves);
      cavities_ = cavityVoxels(index_, cavities);
    }
    size_.leaves = int64_t(index_.leafCount());
    size_.voxels = index_.voxelCount();
    checkMemory(size_, options_);
    detail::chooseWeights(object_, options_, obstacles_, index_.boundingBox(), result_);
  }

  SquaredDistance measureDistance() {
    SquaredDistance distance =
        squaredDistance(index_, obstacles_, result_.weights, stages_.begin("squared_distance"));
    counts_.largestSquaredDistance = distance.largest;
    if (options_.keepDistance)
      result_.distanceSquared = toObjectGrid(distance.values, "distance_squared");
    return distance;
  }

  /// The medial balls, of which the filter may leave some: then the map becomes that of those.
  VoxelSet chooseBalls(PowerMap& map) {
    const bool isFiltered = options_.gamma > 1;
    VoxelSet balls = medialBalls(index_, map, stages_.begin("medial_balls"));
    counts_.medialBalls = counts_.keptBalls = balls.size();
    if (!isFiltered && !options_.keepBalls) return balls;
    const MedialBallTable table = measureBalls(index_, map, balls, &stages_);
    if (options_.keepBalls) result_.balls = listBalls(index_, balls, table);
    if (!isFiltered) return balls;
    VoxelSet kept =
        keptBalls(index_, map, balls, table, options_.gamma, stages_.begin("gamma_filter"));
    counts_.keptBalls = kept.size();
    map = filteredPowerMap(index_, std::move(map), balls, table, kept, &stages_);
    return kept;
  }

  /// Critical points count the voxels of the object alone.
  Flow followFlow(PowerMap& map, const VoxelSet& balls) {
    Flow found = flow(index_, std::move(map.site), map.power, balls, stages_.begin("flow"));
    counts_.criticalPoints = int64_t(found.criticalPoints.size());
    checkPoints();
    for (const VoxelId id : cavities_)
      found.criticalPoints[(found.manifold[index_.rank(id)] & ~Flow::kOwnCell) - 1].leaveToCavity();
    return found;
  }

  /// A sample may have missed where critical points are many.
  void checkPoints() {
    const double more = double(counts_.criticalPoints) / double(std::max<int64_t>(1, size_.points));
    if (options_.maxMemory == 0 || more <= 1) return;
    for (const auto total : {&ObjectSize::points, &ObjectSize::edges, &ObjectSize::grains,
                             &ObjectSize::parts, &ObjectSize::bonds})
      size_.*total = int64_t(more * double(std::max<int64_t>(1, size_.*total)));
    checkMemory(size_, options_);
  }

  void linkManifolds(const Flow& flowMap, const PowerMap& map) {
    result_.graph = manifoldGraph(index_, flowMap, map.power, stages_.begin("manifold_graph"));
    result_.graph.weights = result_.weights;
    if (result_.domain) placeGraph(result_.graph, *result_.domain, result_.open);
    if (options_.keepPower) result_.power = toObjectGrid(map.power, "power");
    if (options_.keepManifold) result_.manifold = toObjectGrid(flowMap.manifold, "manifold");
  }

  /// Grain labels from the manifolds, which they replace.
  GrainLabels labelGrains(VoxelArray<uint32_t> manifold, const Merging& merging) {
    GrainLabels grains = detail::grainsOf(result_.graph, merging);
    grains.label = std::move(manifold);
    detail::parallelForEach(grains.label.size(), size_t(1) << 16, &stages_, [&](size_t i) {
      const uint32_t node = (grains.label[i] & ~Flow::kOwnCell) - 1;
      grains.label[i] = uint32_t(merging.grainOfNode[node]);
    });
    for (const VoxelId id : cavities_) grains.label[index_.rank(id)] = 0;
    return grains;
  }

  void finish(GrainLabels grains) {
    stages_.begin("labels");
    result_.grainVoxels = std::move(grains.voxels);
    result_.grain = toObjectGrid(std::move(grains.label), "grain");
    for (const Int32Grid::Ptr& grid :
         {result_.grain, result_.distanceSquared, result_.power, result_.manifold}) {
      if (!grid) continue;
      copyProvenance(object_, *grid);
      if (result_.domain) setDomain(*grid, *result_.domain);
      describeSegmentation(*grid, options_, result_);
    }
    if (result_.manifold) setGraph(*result_.manifold, result_.graph);
    stages_.finish();
  }

  /// A grid on the object.
  template <typename Values>
  Int32Grid::Ptr toObjectGrid(Values&& values, const char* name) {
    const auto grid = toGrid(index_, std::forward<Values>(values), name, &stages_);
    removeVoxels(*grid, index_, cavities_);
    return grid;
  }

  const MaskGrid& object_;
  SegmentOptions options_;
  Segmentation result_;
  SegmentCounts& counts_ = result_.counts;
  const Obstacles obstacles_;
  detail::Stages stages_;
  ObjectSize size_;                // as far as it is known, if memory is limited
  LeafIndex index_;                // of the body
  std::vector<VoxelId> cavities_;  // its voxels that are none of the object, ascending
};

}  // namespace

Segmentation segment(const MaskGrid& object, const SegmentOptions& options,
                     Interrupter* interrupter) {
  return Segmenter(object, options, interrupter).run();
}

}  // namespace vdb_madf
