// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_filter.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/medial_balls.h"
#include "vdb_madf/slabs/detail/slab_pieces.h"
#include "vdb_madf/slabs/detail/slab_region.h"

namespace vdb_madf::detail {

namespace {

/// A medial ball, and how many voxels map to it.
struct SizedBall {
  Coord center;
  int32_t squaredRadius;
  int64_t cellSize;
};

bool isBetter(const SizedBall& a, const SizedBall& b) {
  return a.squaredRadius != b.squaredRadius ? a.squaredRadius > b.squaredRadius
                                            : a.center < b.center;
}

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

/// Of a connected component of a slab: its best ball, of those that are too small.
struct Component {
  SizedBall best;
  /// In a region, of a component without balls: the best that its voxels map to, across the unknown.
  SizedBall elsewhere;
  int32_t hasBest, hasElsewhere, hasKept;

  void offer(const SizedBall& ball) {
    if (!hasBest || isBetter(ball, best)) best = ball;
    hasBest = 1;
  }
  void offerElsewhere(const SizedBall& ball) {
    if (!hasElsewhere || isBetter(ball, elsewhere)) elsewhere = ball;
    hasElsewhere = 1;
  }
  void join(const Component& other) {
    hasKept |= other.hasKept;
    if (other.hasBest) offer(other.best);
    if (other.hasElsewhere) offerElsewhere(other.elsewhere);
  }
};

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
        keptOffers_(work, "kept") {}

  void run() {
    work_.forEachSlab([&](size_t s) { measureCells(s); });
    work_.forEachSlab([&](size_t s) { gatherCells(s); });
    work_.forEachSlab([&](size_t s) { joinComponents(s); });
    if (work_.isRoot()) rescue();
    work_.exchange();
    work_.forEachSlab([&](size_t s) { keep(s); });
    if (work_.inRegion()) {
      work_.forEachSlab([&](size_t s) { mapKeptInRegion(s); });
    } else {
      keptOffers_.passOn();
      work_.forEachSlab([&](size_t s) { mapKept(s); });
    }
    for (size_t s = work_.firstOwn(); s < work_.endOwn(); ++s) forget(s);
    if (work_.isRoot()) count();
  }

 private:
  /// The balls of a slab's cells, told to the slabs that they belong to.
  void measureCells(size_t s) {
    WorkPart part = work_.part(10, 35, s);
    SlabBody slab = work_.body(s);
    const PowerMap map = slabPowerMap(work_, offers_, s, slab.index, &part);
    const VoxelSet balls = medialBalls(slab.index, map, &part);
    const MedialBallTable table = measureBalls(slab.index, map, balls, &part);
    std::vector<std::vector<SizedBall>> of(work_.slabCount());
    uint32_t rank = 0;
    for (const VoxelId id : balls.members()) {
      const Coord center = slab.index.coord(id);
      of[work_.slabOf(center.z())].push_back(
          {center, table.squaredRadius[rank], table.cellSize[rank]});
      ++rank;
    }
    for (size_t t = 0; t < of.size(); ++t)
      if (!of[t].empty()) work_.sendVector("cells", s, t, of[t]);
    if (work_.inRegion())
      work_.writeVector("elsewhere", s, elsewhere(slab.index, map, balls, table));
  }

  /// The best ball that the voxels of each component map to.
  std::vector<Component> elsewhere(const LeafIndex& index, const PowerMap& map,
                                   const VoxelSet& balls, const MedialBallTable& table) const {
    const ConnectedComponents components(index, work_.interrupter);
    std::vector<Component> found(components.count(), Component{});
    for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
      for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
        for (uint32_t x = 0; x < 8; ++x)
          forEachBit(piece->mask[x], [&](int bit) {
            const VoxelId site = map.site[index.rank(leaf * 512 + x * 64 + uint32_t(bit))];
            found[piece->component].offerElsewhere(
                {index.coord(site), table.squaredRadius[balls.rank(site)], 0});
          });
    return found;
  }

  /// All cells of a slab's balls; which of its components have a ball that is large enough.
  void gatherCells(size_t s) {
    std::vector<SizedBall> balls;
    for (size_t t = 0; t < work_.slabCount(); ++t) {
      const auto more = work_.receiveVector<SizedBall>("cells", t, s);
      balls.insert(balls.end(), more.begin(), more.end());
    }
    joinBalls(balls);
    const SlabBody slab = work_.body(s);
    const ConnectedComponents components(slab.index, work_.interrupter);
    std::vector<Component> found(components.count(), Component{});
    if (work_.inRegion()) found = work_.readVector<Component>("elsewhere", s);
    for (const SizedBall& ball : balls) {
      Component& component = found[components.componentOf(*slab.index.findVoxel(ball.center))];
      if (ball.cellSize >= work_.options.gamma)
        component.hasKept = 1;
      else
        component.offer(ball);
    }
    work_.writeVector("sized-balls", s, balls);
    work_.sendVector("components", s, SlabWork::kRoot, found);
    const auto face = [&](bool isUpper) {
      return facePieces(slab.index, components, work_.cut(s, isUpper));
    };
    work_.writeVector("lowest-components", s, face(false));
    if (s + 1 < work_.slabCount()) work_.sendVector("highest-components", s, s + 1, face(true));
  }

  void joinComponents(size_t s) {
    if (s == 0) return;
    work_.sendVector("joined-components", s, SlabWork::kRoot,
                     pieceJoins(work_.receiveVector<FacePiece>("highest-components", s - 1, s),
                                work_.readVector<FacePiece>("lowest-components", s)));
  }

  /// At the root: the best balls of components that would have none.
  void rescue() {
    PieceUnion components;
    std::vector<Component> all;
    const size_t slabs = work_.slabCount();
    const auto foundIn = [&](size_t s) {
      return work_.receiveVector<Component>("components", s, SlabWork::kRoot);
    };
    for (size_t s = 0; s < slabs; ++s)
      components.add(foundIn(s).size(),
                     work_.receiveVector<PieceJoin>("joined-components", s, SlabWork::kRoot));
    all.assign(components.size(), Component{});
    for (size_t s = 0; s < slabs; ++s) {
      const std::vector<Component> found = foundIn(s);
      for (uint32_t i = 0; i < found.size(); ++i) {
        Component& whole = all[components.find(s, i)];
        whole.join(found[i]);
      }
    }
    std::vector<std::vector<Coord>> rescued(slabs);
    for (const Component& component : all) {
      if (component.hasKept || !(component.hasBest || component.hasElsewhere)) continue;
      const Coord& center = component.hasBest ? component.best.center : component.elsewhere.center;
      rescued[work_.slabOf(center.z())].push_back(center);
    }
    for (size_t s = 0; s < slabs; ++s) work_.sendVector("rescued", SlabWork::kRoot, s, rescued[s]);
  }

  void keep(size_t s) {
    std::vector<Coord> rescued = work_.receiveVector<Coord>("rescued", SlabWork::kRoot, s);
    std::sort(rescued.begin(), rescued.end());
    const auto balls = work_.readVector<SizedBall>("sized-balls", s);
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
    if (work_.inRegion()) {
      for (size_t t = 0; t < work_.slabCount(); ++t)
        if (isInReach(work_, s, t)) work_.sendVector("kept-balls", s, t, kept);
    } else {
      keptOffers_.offer(s, [&](bool isUpper) {
        return siteOffers(slab.index, squaredRadius, work_.weights.z, work_.cut(s, isUpper));
      });
      work_.writeVector("kept-balls", s, kept);
    }
    work_.sendVector("ball-counts", s, SlabWork::kRoot,
                     std::vector<int64_t>{int64_t(balls.size()), int64_t(kept.size())});
  }

  /// The map of the kept balls.
  void mapKept(size_t s) {
    WorkPart part = work_.part(35, 55, s);
    SlabBody slab = work_.body(s);
    PowerMap map;
    map.weights = work_.weights;
    map.foreign = keptOffers_.received(s, slab.index);
    map.site = VoxelArray<VoxelId>(size_t(slab.index.voxelCount()));
    map.power = uniform(slab.index, kUncovered);
    int32_t largest = 0;
    for (const ForeignSite& ball : work_.readVector<ForeignSite>("kept-balls", s)) {
      map.power[slab.index.rank(*slab.index.findVoxel(ball.position))] = -ball.squaredRadius;
      largest = std::max(largest, ball.squaredRadius);
    }
    sweepPower(slab.index, largest, map, &part);
    completion_.begin(s, slab.index, map, &part);
  }

  void mapKeptInRegion(size_t s) {
    WorkPart part = work_.part(35, 55, s);
    SlabBody slab = work_.body(s);
    std::vector<ForeignSite> sites;
    for (size_t t = 0; t < work_.slabCount(); ++t) {
      const auto kept = work_.receiveVector<ForeignSite>("kept-balls", t, s);
      sites.insert(sites.end(), kept.begin(), kept.end());
    }
    PowerMap map = filteredInRegion(work_, s, sites, slab.index, &part);
    completion_.begin(s, slab.index, map, &part);
  }

  void forget(size_t s) {
    for (const char* what : {"sized-balls", "lowest-components", "kept-balls", "elsewhere"})
      work_.remove(what, s);
    for (size_t t = 0; t < work_.slabCount(); ++t)
      for (const char* what : {"cells", "kept-balls"}) work_.removeMessage(what, t, s);
    work_.removeMessage("highest-components", s - 1, s);
    keptOffers_.forget(s);
  }

  void count() {
    counts_.medialBalls = counts_.keptBalls = 0;
    for (size_t s = 0; s < work_.slabCount(); ++s) {
      const auto balls = work_.receiveVector<int64_t>("ball-counts", s, SlabWork::kRoot);
      counts_.medialBalls += balls.at(0);
      counts_.keptBalls += balls.at(1);
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
