// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What segment() must do alike for related inputs: no oracle, so volumes of many leaves, too.

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/grid_values.h"
#include "support/invariants.h"
#include "support/random_case.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

SegmentOptions keepAll(SegmentOptions options = {}) {
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = true;
  return options;
}

/// All that a segmentation says, moved back by `shift`. With kept grids.
struct Everything {
  std::vector<DenseVolume<int64_t>> grids;
  std::vector<std::array<int64_t, 5>> balls, nodes, edges;
  std::array<int64_t, 7> counts{};

  Everything(const Segmentation& s, const CoordBBox& box, const Coord& shift = Coord(0)) {
    CoordBBox moved = box;
    moved.translate(shift);
    for (const auto& grid : {s.grain, s.distanceSquared, s.power, s.manifold}) {
      const DenseVolume<int64_t> there = valuesIn(*grid, moved);
      DenseVolume<int64_t> here(box);
      for (int i = 0; i < here.size(); ++i) here[i] = there[i];
      grids.push_back(here);
    }
    for (const MedialBall& ball : s.balls) {
      const Coord p = ball.center - shift;
      balls.push_back({p.x(), p.y(), p.z(), ball.squaredRadius, ball.cellSize});
    }
    for (const auto& node : s.graph.nodes) {
      const Coord p = node.position - shift;
      nodes.push_back({p.x(), p.y(), p.z(), node.squaredRadius, node.voxels});
    }
    for (const auto& edge : s.graph.edges)
      edges.push_back(
          {edge.first, edge.second, edge.contactFaces, edge.saddleHeight, edge.cellsTouch});
    counts = {s.counts.objectVoxels, s.counts.medialBalls,
              s.counts.keptBalls,    s.counts.criticalPoints,
              s.counts.grains,       s.counts.largestSquaredDistance};  // leaves may differ
  }
  bool operator==(const Everything& o) const {
    return grids == o.grids && balls == o.balls && nodes == o.nodes && edges == o.edges &&
           counts == o.counts;
  }
};

Segmentation segmentObject(const ObjectVolume& object, const SegmentOptions& options,
                           Tiles tiles = Tiles::none) {
  return segment(*toMask(object, tiles), keepAll(options));
}

/// Some cases that the oracle would not refuse, closed or with room in the domain.
RandomCase usableCase(uint64_t seed, const Coord& size) {
  RandomCase c = randomCase(seed, size);
  c.domainInMetadata = false;
  if (!c.domain) {
    c.options.boundary = Boundary::closed;
  } else {
    ++c.domain->max().z();
    c.options.domain = c.domain;
  }
  return c;
}

Coord smallSize(uint64_t seed) {
  Rng rng(seed + 77);
  return {rng.between(1, 14), rng.between(1, 14), rng.between(1, 14)};
}

}  // namespace

TEST_CASE("segment: a translation moves everything and changes nothing", "[segment]") {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    const RandomCase c = usableCase(seed, smallSize(seed));
    INFO(describe(c));
    const Everything expected(segmentObject(c.object, c.options), c.object.box());
    std::vector<Coord> shifts = {{1 << 20, -(1 << 20), 3}, {-4096, 4093, -131}, {-128, 120, 4091}};
    for (int axis = 0; axis < 3; ++axis) {
      Coord shift(0);
      shift[axis] = 1 + int(seed) % 8;  // all of 1..8 in the end: every position within a leaf
      shifts.push_back(shift);
      shift[axis] = -shift[axis];
      shifts.push_back(shift);
    }
    for (const Coord& shift : shifts) {
      SegmentOptions options = c.options;
      if (options.domain)
        options.domain =
            CoordBBox(options.domain->box().min() + shift, options.domain->box().max() + shift);
      const Segmentation moved = segmentObject(translated(c.object, shift), options);
      INFO("by " << shift);
      REQUIRE(Everything(moved, c.object.box(), shift) == expected);
    }
  }
}

TEST_CASE("segment: a closed boundary does not see the domain", "[segment]") {
  for (uint64_t seed = 100; seed < 160; ++seed) {
    RandomCase c = usableCase(seed, smallSize(seed));
    c.options.boundary = Boundary::closed;
    c.options.domain.reset();
    c.options.fillHoles = 0;  // a dent in a face of the domain is no cavity, in an open one it is
    INFO(describe(c));
    const Everything expected(segmentObject(c.object, c.options), c.object.box());
    for (const int margin : {0, 1, 9}) {
      CoordBBox domain = c.object.box();
      domain.expand(margin);
      c.options.domain = domain;
      REQUIRE(Everything(segmentObject(c.object, c.options), c.object.box()) == expected);
    }
    // The nearest background is beside the object: one layer of it is as good as all.
    for (const int margin : {1, 2, 20}) {
      CoordBBox domain = objectBox(c.object);
      if (domain.empty()) continue;
      domain.expand(margin);
      c.options.domain = domain;
      c.options.boundary = Boundary::open;
      REQUIRE(Everything(segmentObject(c.object, c.options), c.object.box()) == expected);
    }
  }
}

TEST_CASE("segment: axis permutations and mirrors keep what ties do not touch", "[segment]") {
  // Ties between equal balls fall to smaller coordinates, so sites, cells, manifolds and labels may
  // change. Distances, least powers and, without a filter, the critical points may not: whether
  // Pi(c) = c is decided before coordinates are compared. Weights go with their axes.
  for (uint64_t seed = 200; seed < 230; ++seed) {
    RandomCase c = usableCase(seed, smallSize(seed));
    c.options.gamma = 0;
    const Segmentation original = segmentObject(c.object, c.options);
    const CoordBBox box = c.object.box();
    std::array<int, 3> from{0, 1, 2};
    do {
      for (int mirrors = 0; mirrors < 8; ++mirrors) {
        const AxisMap map{from, {bool(mirrors & 1), bool(mirrors & 2), bool(mirrors & 4)}};
        SegmentOptions options = c.options;
        if (options.domain) options.domain = map(options.domain->box());
        if (const auto w = options.weights)
          options.weights = VoxelWeights{(*w)[from[0]], (*w)[from[1]], (*w)[from[2]]};
        const Segmentation turned = segmentObject(permuted(c.object, map), options);
        INFO(describe(c) << from[0] << from[1] << from[2] << " mirrored " << mirrors);
        REQUIRE(valuesIn(*turned.distanceSquared, map(box)) ==
                permuted(valuesIn(*original.distanceSquared, box), map));
        REQUIRE(valuesIn(*turned.power, map(box)) == permuted(valuesIn(*original.power, box), map));
        std::set<std::pair<Coord, int32_t>> critical, expected;
        for (const auto& node : turned.graph.nodes)
          critical.insert({node.position, node.squaredRadius});
        for (const auto& node : original.graph.nodes)
          expected.insert({map(node.position), node.squaredRadius});
        REQUIRE(critical == expected);
      }
    } while (std::next_permutation(from.begin(), from.end()));
  }
}

TEST_CASE("segment: objects far from each other are segmented alone", "[segment]") {
  for (uint64_t seed = 300; seed < 340; ++seed) {
    RandomCase a = usableCase(seed, smallSize(seed)), b = usableCase(seed + 500, smallSize(seed));
    a.options.boundary = Boundary::closed;
    a.options.domain.reset();
    // b behind a in x, so that its labels follow; a gap of one voxel does.
    const Coord at(a.object.box().max().x() + 2, a.object.box().min().y(),
                   a.object.box().min().z());
    b.object = translated(b.object, at - b.object.box().min());
    CoordBBox both = a.object.box();
    both.expand(b.object.box());
    ObjectVolume object = withBox(a.object, both);
    for (int i = 0; i < b.object.size(); ++i)
      if (b.object[i]) object[b.object.coord(i)] = 1;

    const Segmentation first = segmentObject(a.object, a.options);
    const Segmentation second = segmentObject(b.object, a.options);
    const Segmentation together = segmentObject(object, a.options);
    INFO(describe(a) << describe(b));
    CHECK(together.counts.medialBalls == first.counts.medialBalls + second.counts.medialBalls);
    CHECK(together.counts.keptBalls == first.counts.keptBalls + second.counts.keptBalls);
    const auto expectUnion = [&](const Int32Grid& g, const Int32Grid& g1, const Int32Grid& g2,
                                 int64_t offset) {
      DenseVolume<int64_t> expected(both);
      for (int i = 0; i < expected.size(); ++i) {
        const Coord p = expected.coord(i);
        if (a.object.get(p, 0)) expected[i] = g1.tree().getValue(p);
        if (b.object.get(p, 0)) expected[i] = g2.tree().getValue(p) + offset;
      }
      REQUIRE(difference("union", g, object, expected) == "");
    };
    expectUnion(*together.grain, *first.grain, *second.grain, first.counts.grains);
    expectUnion(*together.manifold, *first.manifold, *second.manifold, first.counts.criticalPoints);
    expectUnion(*together.power, *first.power, *second.power, 0);
  }
}

TEST_CASE("segment: by angle, a larger theta gives coarser grains", "[segment]") {
  for (uint64_t seed = 400; seed < 440; ++seed) {
    RandomCase c = usableCase(seed, smallSize(seed));
    c.options.merge.mode = MergeMode::angle;
    c.options.tidy = 0;  // tidied, grains share no manifolds
    c.options.merge.minGrain = 0;
    Segmentation finer;
    for (const double theta : {-1.0, -0.95, -0.8, -0.5, 0.0, 1.0}) {
      c.options.merge.theta = theta;
      const Segmentation coarser = segmentObject(c.object, c.options);
      INFO(describe(c));
      if (finer.grain) REQUIRE(grainsAreUnionsOfManifolds(*finer.grain, *coarser.grain) == "");
      if (theta == -1) REQUIRE(coarser.counts.grains == coarser.counts.criticalPoints);
      finer = coarser;
    }
  }
}

TEST_CASE("segment: threads do not change anything", "[segment][long]") {
  // Enough leaves for every loop to be cut up.
  for (const VolumeKind kind : {VolumeKind::blurredNoise, VolumeKind::roughBalls})
    for (const int64_t gamma : {0, 20}) {
      Rng rng(uint64_t(gamma) + 5);
      const ObjectVolume object = randomVolume(kind, boxAt({-43, -40, 100}, {90, 83, 97}), rng);
      SegmentOptions options = keepAll();
      options.gamma = gamma;
      options.domain = object.box();
      if (gamma > 0) options.weights = VoxelWeights{25, 144, 25};
      const auto mask = toMask(object);
      std::optional<Everything> expected;
      for (const int threads : {1, 2, 3, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        size_t(threads));
        Segmentation result;
        tbb::task_arena(threads).execute([&] { result = segment(*mask, options); });
        const Everything all(result, object.box());
        if (!expected) {
          expected = all;
          REQUIRE(anyViolation(result, *mask, gamma) == "");
        }
        INFO(name(kind) << ", gamma " << gamma << ", " << threads << " threads");
        REQUIRE(all == *expected);
      }
    }
}

TEST_CASE("segment: two calls at once do not disturb each other", "[segment]") {
  // Two objects and options, each cut by two threads of the caller's: also the same mask twice.
  std::vector<MaskGrid::Ptr> masks;
  std::vector<CoordBBox> boxes;
  std::vector<SegmentOptions> options;
  std::vector<Everything> expected;
  for (const int64_t gamma : {0, 20}) {
    Rng rng(uint64_t(gamma) + 15);
    const ObjectVolume object =
        randomVolume(VolumeKind::roughBalls, boxAt({-43, -40, 100}, {50, 43, 57}), rng);
    masks.push_back(toMask(object));
    boxes.push_back(object.box());
    options.push_back(keepAll());
    options.back().gamma = gamma;
    expected.emplace_back(segment(*masks.back(), options.back()), boxes.back());
  }
  std::atomic<int> differences{0};
  const auto work = [&](size_t first) {
    for (size_t i = 0; i < 6; ++i) {
      const size_t n = (first + i / 2) % 2;
      if (!(Everything(segment(*masks[n], options[n]), boxes[n]) == expected[n])) ++differences;
    }
  };
  // One with TBB's own threads, one that keeps to itself.
  std::thread limited([&] { tbb::task_arena(1).execute([&] { work(0); }); });
  std::thread free([&] { work(1); });
  limited.join();
  free.join();
  CHECK(differences == 0);
}

TEST_CASE("segment: tiles are the voxels they hold", "[segment]") {
  for (uint64_t seed = 500; seed < 530; ++seed) {
    RandomCase c = usableCase(seed, Coord(20, 26, 24));
    Rng rng(seed);
    c.object = randomVolume(VolumeKind::wholeLeaves, boxAt({-8, 5, -19}, {20, 26, 24}), rng);
    c.options.domain.reset();
    c.options.boundary = Boundary::closed;
    INFO(describe(c));
    const CoordBBox box = c.object.box();
    REQUIRE(Everything(segmentObject(c.object, c.options, Tiles::wherePossible), box) ==
            Everything(segmentObject(c.object, c.options), box));
  }
}

TEST_CASE("segment: a tile of an internal node is the voxels it holds", "[segment]") {
  const auto tiled = MaskGrid::create();
  tiled->tree().addTile(2, Coord(-128, 0, 128), true, true);  // 128^3 voxels
  tiled->tree().setValueOn({-129, 64, 192});                  // and one on its face
  const auto voxels = tiled->deepCopy();
  voxels->tree().voxelizeActiveTiles();
  const Segmentation a = segment(*tiled, keepAll()), b = segment(*voxels, keepAll());
  CHECK(a.counts.objectVoxels == 128 * 128 * 128 + 1);
  CHECK(a.counts.leaves == 16 * 16 * 16 + 1);
  CHECK(a.counts.largestSquaredDistance == 64 * 64);
  const auto sameGrid = [](const Int32Grid& first, const Int32Grid& second) {
    if (first.activeVoxelCount() != second.activeVoxelCount()) return false;
    const auto accessor = second.getConstAccessor();
    for (auto value = first.cbeginValueOn(); value; ++value)
      if (accessor.getValue(value.getCoord()) != *value) return false;
    return true;
  };
  CHECK(sameGrid(*a.distanceSquared, *b.distanceSquared));
  CHECK(sameGrid(*a.power, *b.power));
  CHECK(sameGrid(*a.manifold, *b.manifold));
  CHECK(sameGrid(*a.grain, *b.grain));
  CHECK(tiled->tree().activeTileCount() == 1);  // the input is left alone
}

namespace {

/// Says stop at one poll, or from that poll on; 0: never.
class StopAt : public Interrupter {
 public:
  StopAt(int poll, bool forGood) : poll_(poll), forGood_(forGood) {}
  void start(const char* /*name*/) override { ++open_; }
  void end() override { --open_; }
  bool wasInterrupted(int percent) override {
    percentInRange_ = percentInRange_ && percent >= -1 && percent <= 100;
    const int poll = ++polls_;
    return poll_ > 0 && (poll == poll_ || (forGood_ && poll > poll_));
  }
  int polls() const { return polls_; }
  bool balanced() const { return open_ == 0; }
  bool percentInRange() const { return percentInRange_; }

 private:
  int poll_;
  bool forGood_;
  std::atomic<int> polls_{0}, open_{0};
  std::atomic<bool> percentInRange_{true};
};

}  // namespace

TEST_CASE("segment: stops at any poll of the interrupter, with no result", "[segment][long]") {
  Rng rng(3);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-3, -40, 100}, {48, 43, 57}), rng);
  const auto mask = toMask(object);
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
    for (const int64_t gamma : {0, 20}) {
      SegmentOptions options = keepAll();
      options.gamma = gamma;
      StopAt never(0, false);
      const Everything expected(segment(*mask, options, &never), object.box());
      CHECK(never.polls() > 10);
      CHECK(never.percentInRange());
      // With several threads the number of polls may vary from run to run.
      const int last = threads == 1 ? never.polls() : never.polls() / 2;
      for (int poll = 1; poll <= last; ++poll)
        for (const bool forGood : {false, true}) {
          StopAt stop(poll, forGood);
          INFO("poll " << poll << " of " << never.polls() << ", " << threads << " threads");
          REQUIRE_THROWS_AS(segment(*mask, options, &stop), Interrupted);
        }
      // Nothing is left behind: the next run is as the first.
      CHECK(Everything(segment(*mask, options), object.box()) == expected);
    }
  }
}

TEST_CASE("segment: the percentage that the interrupter hears never falls", "[segment]") {
  class Hears : public Interrupter {
   public:
    bool wasInterrupted(int percent) override {
      if (percent >= 0) percents.push_back(percent);
      return false;
    }
    std::vector<int> percents;
  };
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  Rng rng(3);
  const auto mask =
      toMask(randomVolume(VolumeKind::roughBalls, boxAt({0, 0, 0}, {40, 43, 45}), rng));
  for (const int64_t gamma : {0, 20}) {
    SegmentOptions options;
    options.gamma = gamma;
    Hears hears;
    segment(*mask, options, &hears);
    CHECK(std::is_sorted(hears.percents.begin(), hears.percents.end()));
    CHECK(hears.percents.back() > 90);
  }
}

TEST_CASE("segment: tells the interrupter the end of every stage it told the start of",
          "[segment]") {
  const auto mask = toMask(fromPicture("###/###/###|###/###/###"));
  SegmentOptions options = keepAll();
  options.gamma = 2;
  StopAt never(0, false);
  segment(*mask, options, &never);
  CHECK(never.balanced());
  for (int poll = 1; poll <= never.polls(); ++poll) {
    StopAt stop(poll, true);
    INFO("stopped at poll " << poll << " of " << never.polls());
    REQUIRE_THROWS_AS(segment(*mask, options, &stop), Interrupted);
    CHECK(stop.balanced());
  }
}
