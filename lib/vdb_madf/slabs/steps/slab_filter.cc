// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/steps/slab_filter.h"

#include <algorithm>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/method/detail/component_ball.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/cuts/slab_pieces.h"
#include "vdb_madf/slabs/steps/slab_region.h"

namespace vdb_madf::detail {

/// A medial ball, and how many voxels map to it.
struct SizedBall {
  Coord center;
  int32_t squaredRadius;
  int64_t cellSize;
};

namespace {

/// The balls of the same center as one.
void joinBalls(std::vector<SizedBall>& balls) {
  std::sort(balls.begin(), balls.end(),
            [](const SizedBall& a, const SizedBall& b) { return a.center < b.center; });
  size_t count = 0;
  for (const SizedBall& ball : balls) {
    if (count > 0 && balls[count - 1].center == ball.center)
      balls[count - 1].cellSize += ball.cellSize;
    else
      balls[count++] = ball;
  }
  balls.resize(count);
}

}  // namespace

/// The balls of a slab.
struct BallCounts {
  int64_t medial, kept;
};

namespace {

/// The same for all voxels.
VoxelArray<int32_t> uniform(const LeafIndex& index, int32_t value) {
  constexpr size_t kVoxelGrain = size_t(1) << 16;
  VoxelArray<int32_t> values(size_t(index.voxelCount()));
  parallelFor(values.size(), kVoxelGrain, nullptr, [&](size_t begin, size_t end) {
    std::fill(values.data() + begin, values.data() + end, value);
  });
  return values;
}

class SlabFilter {
 public:
  SlabFilter(SlabWork& work, const SlabOffers& offers, SlabCompletion& completion,
             SegmentCounts& counts)
      : work_(work),
        offers_(offers),
        completion_(completion),
        counts_(counts),
        keptOffers_(work, kOffersOfKeptBalls) {}

  void run() {
    work_.steps.forEachSlab(Step::cells, [&](size_t s) { measureCells(s); });
    work_.steps.forEachSlab(Step::balls, [&](size_t s) { gatherCells(s); });
    work_.steps.forEachSlab(Step::components, [&](size_t s) { joinComponents(s); });
    if (work_.plan.isRoot()) rescue();
    work_.steps.exchange();
    work_.steps.forEachSlab(Step::kept, [&](size_t s) { keep(s); });
    if (work_.facts.inRegion()) {
      work_.steps.forEachSlab(Step::keptMap, [&](size_t s) { mapKeptInRegion(s); });
    } else {
      keptOffers_.passOn();
      work_.steps.forEachSlab(Step::keptMap, [&](size_t s) { mapKept(s); });
    }
    if (work_.plan.isRoot()) count();
  }

 private:
  /// The balls of a slab's cells, told to the slabs that they belong to.
  void measureCells(size_t s) {
    WorkPart part = work_.steps.part(Step::cells, s);
    SlabBody slab = work_.body(s);
    const PowerMap map = slabPowerMap(work_, offers_, s, slab.index, &part);
    const VoxelSet balls = medialBalls(slab.index, map, &part);
    const MedialBallTable table = measureBalls(slab.index, map, balls, &part);
    std::vector<std::vector<SizedBall>> of(work_.plan.slabCount());
    uint32_t rank = 0;
    for (const VoxelId id : balls.members()) {
      const Coord center = slab.index.coord(id);
      of[work_.plan.slabOf(center.z())].push_back(
          {center, table.squaredRadius[rank], table.cellSize[rank]});
      ++rank;
    }
    for (size_t t = 0; t < of.size(); ++t)
      if (!of[t].empty()) work_.store.send(kCells, s, t, of[t]);
    if (work_.facts.inRegion())
      work_.store.write(kElsewhere, s, elsewhere(slab.index, map, balls, table));
  }

  /// The best ball that the voxels of each component map to.
  std::vector<ComponentBall> elsewhere(const LeafIndex& index, const PowerMap& map,
                                       const VoxelSet& balls, const MedialBallTable& table) const {
    const ConnectedComponents components(index, work_.interrupter);
    std::vector<ComponentBall> found(components.count());
    for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
        for (uint32_t x = 0; x < 8; ++x)
          forEachBit(piece->mask[x], [&](int bit) {
            const VoxelId site = map.site[index.rank(voxelId(leaf, x, size_t(bit)))];
            found[piece->component].offer({ComponentBall::elsewhere,
                                           table.squaredRadius[balls.rank(site)],
                                           index.coord(site)});
          });
    return found;
  }

  /// All cells of a slab's balls; which of its components have a ball that is large enough.
  void gatherCells(size_t s) {
    std::vector<SizedBall> balls = work_.store.receiveAll(kCells, s);
    joinBalls(balls);
    const SlabBody slab = work_.body(s);
    const ConnectedComponents components(slab.index, work_.interrupter);
    std::vector<ComponentBall> found(components.count());
    if (work_.facts.inRegion()) found = work_.store.read(kElsewhere, s);
    for (const SizedBall& ball : balls)
      found[components.componentOf(*slab.index.findVoxel(ball.center))].offer(
          {ball.cellSize >= work_.options.gamma ? ComponentBall::kept : ComponentBall::own,
           ball.squaredRadius, ball.center});
    work_.store.write(kSizedBalls, s, balls);
    work_.store.send(kComponents, s, kRoot, found);
    const auto face = [&](bool isUpper) {
      return facePieces(slab.index, components, work_.plan.cut(s, isUpper));
    };
    work_.store.write(kLowestComponents, s, face(false));
    if (s + 1 < work_.plan.slabCount()) work_.store.send(kComponentsBelow, s, s + 1, face(true));
  }

  void joinComponents(size_t s) {
    if (s == 0) return;
    work_.store.send(kJoinedComponents, s, kRoot,
                     pieceJoins(work_.store.receive(kComponentsBelow, s - 1, s),
                                work_.store.read(kLowestComponents, s)));
  }

  /// At the root: the best balls of components that would have none.
  void rescue() {
    PieceUnion components;
    const size_t slabs = work_.plan.slabCount();
    const auto foundIn = [&](size_t s) { return work_.store.receive(kComponents, s, kRoot); };
    for (size_t s = 0; s < slabs; ++s)
      components.add(foundIn(s).size(), work_.store.receive(kJoinedComponents, s, kRoot));
    std::vector<ComponentBall> best(components.size());
    for (size_t s = 0; s < slabs; ++s) {
      const std::vector<ComponentBall> found = foundIn(s);
      for (uint32_t i = 0; i < found.size(); ++i) best[components.find(s, i)].offer(found[i]);
    }
    std::vector<std::vector<Coord>> rescued(slabs);
    for (const ComponentBall& ball : best)
      if (ball.isRescued()) rescued[work_.plan.slabOf(ball.center.z())].push_back(ball.center);
    for (size_t s = 0; s < slabs; ++s) work_.store.send(kRescued, kRoot, s, rescued[s]);
  }

  void keep(size_t s) {
    std::vector<Coord> rescued = work_.store.receive(kRescued, kRoot, s);
    std::sort(rescued.begin(), rescued.end());
    const auto balls = work_.store.read(kSizedBalls, s);
    std::vector<ForeignSite> kept;
    const SlabBody slab = work_.body(s);
    VoxelArray<int32_t> squaredRadius = uniform(slab.index, 0);
    for (const SizedBall& ball : balls) {
      if (ball.cellSize < work_.options.gamma &&
          !std::binary_search(rescued.begin(), rescued.end(), ball.center))
        continue;
      kept.push_back({ball.center, ball.squaredRadius});
      squaredRadius[slab.index.rank(*slab.index.findVoxel(ball.center))] = ball.squaredRadius;
    }
    if (work_.facts.inRegion()) {
      for (size_t t = 0; t < work_.plan.slabCount(); ++t)
        if (isInReach(work_, s, t)) work_.store.send(kKeptInReach, s, t, kept);
    } else {
      keptOffers_.offer(s, [&](bool isUpper) {
        return siteOffers(slab.index, squaredRadius, work_.facts.weights.z,
                          work_.plan.cut(s, isUpper));
      });
      work_.store.write(kKept, s, kept);
    }
    work_.store.send(kBallCounts, s, kRoot, {int64_t(balls.size()), int64_t(kept.size())});
  }

  /// The map of the kept balls.
  void mapKept(size_t s) {
    WorkPart part = work_.steps.part(Step::keptMap, s);
    SlabBody slab = work_.body(s);
    PowerMap map;
    map.weights = work_.facts.weights;
    map.foreign = keptOffers_.received(s, slab.index);
    map.site = VoxelArray<VoxelId>(size_t(slab.index.voxelCount()));
    map.power = uniform(slab.index, kUncovered);
    int32_t largest = 0;
    for (const ForeignSite& ball : work_.store.read(kKept, s)) {
      map.power[slab.index.rank(*slab.index.findVoxel(ball.position))] = -ball.squaredRadius;
      largest = std::max(largest, ball.squaredRadius);
    }
    sweepPower(slab.index, largest, map, &part);
    completion_.begin(s, slab.index, map, &part);
  }

  void mapKeptInRegion(size_t s) {
    WorkPart part = work_.steps.part(Step::keptMap, s);
    SlabBody slab = work_.body(s);
    PowerMap map =
        filteredInRegion(work_, s, work_.store.receiveAll(kKeptInReach, s), slab.index, &part);
    completion_.begin(s, slab.index, map, &part);
  }

  void count() {
    counts_.medialBalls = counts_.keptBalls = 0;
    for (size_t s = 0; s < work_.plan.slabCount(); ++s) {
      const auto balls = work_.store.receive(kBallCounts, s, kRoot);
      counts_.medialBalls += balls.medial;
      counts_.keptBalls += balls.kept;
    }
  }

  SlabWork& work_;
  const SlabOffers& offers_;
  SlabCompletion& completion_;
  SegmentCounts& counts_;
  SlabOffers keptOffers_;
};

}  // namespace

void filterInSlabs(SlabWork& work, const SlabOffers& offers, SlabCompletion& completion,
                   SegmentCounts& counts) {
  SlabFilter(work, offers, completion, counts).run();
}

}  // namespace vdb_madf::detail
