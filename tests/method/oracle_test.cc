// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The oracle itself, against values computed by hand and against its definitions written without
// any restriction of the candidates.

#include "support/oracle.h"

#include <limits>
#include <string>
#include <vector>

#include "support/random_volume.h"

#include "support/catch.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/method/boundary.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Values = std::vector<int64_t>;

std::vector<Coord> positions(const ManifoldGraph& graph) {
  std::vector<Coord> result;
  for (const auto& node : graph.nodes) result.push_back(node.position);
  return result;
}

SegmentOptions merging(double theta, MergeMode mode, int64_t gamma = 0) {
  SegmentOptions options;
  options.gamma = gamma;
  options.merge.theta = theta;
  options.merge.mode = mode;
  options.merge.delta = 0;
  options.fillHoles = options.tidy = 0;
  return options;
}

int64_t grains(const ObjectVolume& object, double theta, MergeMode mode, int64_t gamma = 0) {
  return oracleSegment(object, {}, merging(theta, mode, gamma)).counts.grains;
}

}  // namespace

TEST_CASE("oracle: an empty object has no grains", "[oracle]") {
  for (const auto& domain :
       {std::optional<CoordBBox>(), std::optional(boxAt({0, 0, 0}, {2, 2, 2}))}) {
    const OracleResult result =
        oracleSegment(ObjectVolume(boxAt({0, 0, 0}, {2, 1, 2})), domain, {});
    CHECK(result.counts.objectVoxels == 0);
    CHECK(result.counts.grains == 0);
    CHECK(result.counts.leaves == 0);
    CHECK(result.graph.nodes.empty());
  }
  CHECK(oracleSegment(ObjectVolume(), {}, {}).counts.grains == 0);
}

TEST_CASE("oracle: one voxel is one ball, one critical point, one grain", "[oracle]") {
  const OracleResult result = oracleSegment(fromPicture("#", {-3, 5, 7}), {}, {});
  const Coord p(-3, 5, 7);
  CHECK(result.distance[p] == 1);
  CHECK(result.filtered.power[p] == -1);
  CHECK(result.grain[p] == 1);
  REQUIRE(result.balls.size() == 1);
  CHECK(result.balls[0].center == p);
  CHECK(result.balls[0].squaredRadius == 1);
  CHECK(result.balls[0].cellSize == 1);
  CHECK(result.counts.medialBalls == 1);
  CHECK(result.counts.keptBalls == 1);
  CHECK(result.counts.criticalPoints == 1);
  CHECK(result.counts.grains == 1);
  CHECK(result.counts.largestSquaredDistance == 1);
  CHECK(result.counts.leaves == 1);
}

TEST_CASE("oracle: on a thin row every voxel is critical", "[oracle]") {
  // Background beside each voxel: D = 1. pi_x(p) = |p-x|^2 - 1 is least, -1, at x = p.
  // Neighbors: cos = (1 - 1 - 1) / 2 = -0.5, h = min(1, 1) = 1.
  const ObjectVolume object = fromPicture("#####");
  const OracleResult result = oracleSegment(object, {}, merging(-0.5, MergeMode::angle));
  CHECK(rowOf(result.distance, 0, 0) == Values{1, 1, 1, 1, 1});
  CHECK(rowOf(result.filtered.power, 0, 0) == Values{-1, -1, -1, -1, -1});
  CHECK(rowOf(result.manifold, 0, 0) == Values{1, 2, 3, 4, 5});
  CHECK(rowOf(result.grain, 0, 0) == Values{1, 2, 3, 4, 5});  // -0.5 < -0.5 is false
  REQUIRE(result.graph.edges.size() == 4);
  CHECK(result.graph.edges[2] == ManifoldGraph::Edge{2, 3, 1, 1, true});
  CHECK(grains(object, -0.4999, MergeMode::angle) == 1);
  CHECK(grains(object, -1, MergeMode::angle) == 5);
  CHECK(grains(object, -1, MergeMode::neck) == 1);  // 1 >= 1 * 1
}

TEST_CASE("oracle: weights measure along their axes", "[oracle]") {
  // A row along z. Background is 3 away beside it and 2 at its ends: D = 4 or 9. At an end
  // the next voxel's ball has 4 - 9. Neighbors: cos = (4 - 9 - 9) / 18 = -0.78.
  const ObjectVolume object = fromPicture("#####");
  SegmentOptions options = merging(-0.8, MergeMode::angle);
  options.weights = VoxelWeights{9, 9, 4};
  const OracleResult result = oracleSegment(object, {}, options);
  CHECK(rowOf(result.distance, 0, 0) == Values{4, 9, 9, 9, 4});
  CHECK(rowOf(result.filtered.power, 0, 0) == Values{-5, -9, -9, -9, -5});
  CHECK(rowOf(result.manifold, 0, 0) == Values{1, 1, 2, 3, 3});
  CHECK(result.counts.grains == 3);
  options.merge.theta = -0.7;
  CHECK(oracleSegment(object, {}, options).counts.grains == 1);
  // Across the row 1 is nearest.
  options.weights = VoxelWeights{9, 1, 4};
  CHECK(rowOf(oracleSegment(object, {}, options).distance, 0, 0) == Values{1, 1, 1, 1, 1});
}

TEST_CASE("oracle: equal power goes to the larger ball", "[oracle]") {
  // A 3 x 3 x 3 block: D = 4 at the center, 1 elsewhere. pi of the center's ball is 1 - 4, 2 - 4, 3
  // - 4 at face, edge and corner voxels; the corners' own balls have -1 too.
  const ObjectVolume object = fromPicture("###/###/###|###/###/###|###/###/###", Coord(-1));
  const OracleResult result = oracleSegment(object, {}, {});
  CHECK(rowOf(result.distance, 0, 0) == Values{1, 4, 1});
  CHECK(rowOf(result.distance, 0, 1) == Values{1, 1, 1});
  CHECK(rowOf(result.filtered.power, 0, 0) == Values{-3, -4, -3});
  CHECK(rowOf(result.filtered.power, 1, 0) == Values{-2, -3, -2});
  CHECK(rowOf(result.filtered.power, 1, 1) == Values{-1, -2, -1});
  REQUIRE(result.balls.size() == 1);
  CHECK(result.balls[0].center == Coord(0));
  CHECK(result.balls[0].cellSize == 27);
  CHECK(result.counts.criticalPoints == 1);
  CHECK(result.counts.leaves == 8);  // one in each octant around 0
}

TEST_CASE("oracle: a rod of three equal balls, filtered", "[oracle]") {
  // 3 x 3 x 5 voxels: D = 4 at z = 1, 2, 3 of the middle line, 1 elsewhere. Each of these three
  // keeps itself (-4 against 1 - 4); the planes z = 0, 1 map to the first, 2 to the second, 3, 4 to
  // the third. Neighbors: cos = (1 - 8) / 8 = -0.875; h = 4, on the middle line.
  const std::string slice = "#####/#####/#####";
  const ObjectVolume object = fromPicture(slice + "|" + slice + "|" + slice);

  SECTION("no filter") {
    for (const int64_t gamma : {0, 1, 9}) {
      const OracleResult result = oracleSegment(object, {}, merging(-0.9, MergeMode::angle, gamma));
      CHECK(rowOf(result.distance, 1, 1) == Values{1, 4, 4, 4, 1});
      CHECK(rowOf(result.filtered.power, 1, 1) == Values{-3, -4, -4, -4, -3});
      CHECK(rowOf(result.manifold, 0, 0) == Values{1, 1, 2, 3, 3});
      CHECK(rowOf(result.grain, 0, 2) == Values{1, 1, 2, 3, 3});
      REQUIRE(result.graph.edges.size() == 2);
      CHECK(result.graph.edges[0] == ManifoldGraph::Edge{0, 1, 9, 4, true});
      CHECK(result.graph.edges[1] == ManifoldGraph::Edge{1, 2, 9, 4, true});
      CHECK(result.graph.nodes[0].voxels == 18);
      CHECK(result.graph.nodes[1].voxels == 9);
      CHECK(result.counts.keptBalls == 3);
    }
    CHECK(grains(object, -0.8, MergeMode::angle) == 1);  // -0.875 < -0.8
  }
  SECTION("gamma 10 drops the ball in the middle; the tie goes to the smaller coordinate") {
    // Power of the plane z = 2 to both of the others: 1 - 4 + (0, 1 or 2) < 0.
    const OracleResult result = oracleSegment(object, {}, merging(-0.9, MergeMode::angle, 10));
    CHECK(result.counts.medialBalls == 3);
    CHECK(result.counts.keptBalls == 2);
    CHECK(rowOf(result.filtered.power, 1, 1) == Values{-3, -4, -3, -4, -3});
    CHECK(rowOf(result.filtered.power, 0, 0) == Values{-1, -2, -1, -2, -1});
    CHECK(rowOf(result.manifold, 0, 2) == Values{1, 1, 1, 2, 2});
    REQUIRE(result.graph.edges.size() == 1);
    CHECK(result.graph.edges[0] == ManifoldGraph::Edge{0, 1, 9, 3, true});  // min(3, 4)
    // cos = (4 - 8) / 8 = -0.5; (1 + 0.5) / 2 * 4 = 3 <= h
    CHECK(grains(object, -0.5, MergeMode::angle, 10) == 2);
    CHECK(grains(object, -0.5, MergeMode::neck, 10) == 1);
    CHECK(grains(object, -0.51, MergeMode::both, 10) == 2);
  }
  SECTION("gamma 19 drops all: the component keeps its best ball and is completed from it") {
    // (1, 1, 1): 4 - 4 at z = 3 is not covered, 9 - 4 at z = 4.
    const OracleResult result = oracleSegment(object, {}, merging(-0.9, MergeMode::both, 19));
    CHECK(result.kept == std::vector<Coord>{Coord(1, 1, 1)});
    CHECK(rowOf(result.filtered.power, 1, 1) == Values{-3, -4, -3, 0, 5});
    CHECK(result.counts.grains == 1);
    CHECK(result.counts.medialBalls == 3);
    CHECK(result.balls.size() == 3);
  }
}

TEST_CASE("oracle: uncovered voxels meet between two blocks", "[oracle]") {
  // Blocks around z = 1 and z = 9, joined by single voxels z = 3..7. gamma 2 keeps the two centers
  // (D = 4). The row's voxels take the nearer one; z = 5 has 16 - 4 to both: smaller coordinate.
  ObjectVolume object(boxAt({0, 0, 0}, {3, 3, 11}));
  addBlock(object, {1, 1, 1});
  addBlock(object, {1, 1, 9});
  for (int z = 3; z <= 7; ++z) object[Coord(1, 1, z)] = 1;
  const OracleResult result = oracleSegment(object, {}, merging(1, MergeMode::neck, 2));
  CHECK(positions(result.graph) == std::vector<Coord>{{1, 1, 1}, {1, 1, 9}});
  CHECK(rowOf(result.filtered.power, 1, 1) == Values{-3, -4, -3, 0, 5, 12, 5, 0, -3, -4, -3});
  CHECK(rowOf(result.manifold, 1, 1) == Values{1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2});
  REQUIRE(result.graph.edges.size() == 1);
  CHECK(result.graph.edges[0] == ManifoldGraph::Edge{0, 1, 1, -12, true});
  CHECK(result.counts.grains == 2);  // no neck at h <= 0, even with theta 1
}

TEST_CASE("oracle: a better site that arrives later replaces the earlier one", "[oracle]") {
  // In the plane x = 1: block A around (y, z) = (1, 1), block B around (5, 8), and single voxels
  // along y = 1 from A to z = 11, down to y = 5 and back to B. Powers on y = 1: (z - 1)^2 - 4 to A,
  // (z - 8)^2 + 16 - 4 to B: A at z <= 5, B from z = 6 on. A reaches z = 8 in round 6, B in
  // round 9.
  ObjectVolume object(boxAt({0, 0, 0}, {3, 7, 12}));
  addBlock(object, {1, 1, 1});
  addBlock(object, {1, 5, 8});
  for (int z = 3; z <= 11; ++z) object[Coord(1, 1, z)] = 1;
  for (int y = 2; y <= 5; ++y) object[Coord(1, y, 11)] = 1;
  object[Coord(1, 5, 10)] = 1;
  const OracleResult result = oracleSegment(object, {}, merging(-1, MergeMode::angle, 2));
  CHECK(positions(result.graph) == std::vector<Coord>{{1, 1, 1}, {1, 5, 8}});
  CHECK(rowOf(result.manifold, 1, 1) == Values{1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2});
  CHECK(rowOf(result.filtered.power, 1, 1) == Values{-3, -4, -3, 0, 5, 12, 16, 13, 12, 13, 16, 21});
}

TEST_CASE("oracle: a small loose piece keeps its best ball", "[oracle]") {
  // The pair at z = 5, 6 (D = 1, cells of one voxel) keeps the smaller coordinate of two equals.
  ObjectVolume object(boxAt({0, 0, 0}, {3, 3, 7}));
  addBlock(object, {1, 1, 1});
  object[Coord(1, 1, 5)] = object[Coord(1, 1, 6)] = 1;
  const OracleResult result = oracleSegment(object, {}, merging(-1, MergeMode::both, 20));
  CHECK(result.kept == std::vector<Coord>{{1, 1, 1}, {1, 1, 5}});
  CHECK(rowOf(result.grain, 1, 1) == Values{1, 1, 1, 0, 0, 2, 2});
  CHECK(result.filtered.power[Coord(1, 1, 6)] == 0);
}

TEST_CASE("oracle: open and closed boundaries", "[oracle]") {
  const ObjectVolume object = fromPicture("#####");
  SegmentOptions options;
  SECTION("background before and behind the row") {
    const OracleResult result = oracleSegment(object, boxAt({0, 0, -1}, {1, 1, 7}), options);
    CHECK(result.open);
    CHECK(rowOf(result.distance, 0, 0) == Values{1, 4, 9, 4, 1});
    CHECK(rowOf(result.filtered.power, 0, 0) == Values{-5, -8, -9, -8, -5});
    CHECK(result.counts.criticalPoints == 1);
  }
  SECTION("background on one side only") {
    const OracleResult result = oracleSegment(object, boxAt({0, 0, -1}, {1, 1, 6}), options);
    CHECK(rowOf(result.distance, 0, 0) == Values{1, 4, 9, 16, 25});
    CHECK(rowOf(result.filtered.power, 0, 0) == Values{-9, -16, -21, -24, -25});
  }
  SECTION("closed, or automatic without a domain") {
    options.boundary = Boundary::closed;
    CHECK(rowOf(oracleSegment(object, boxAt({0, 0, -1}, {1, 1, 7}), options).distance, 0, 0) ==
          Values{1, 1, 1, 1, 1});
    options.boundary = Boundary::automatic;
    CHECK_FALSE(oracleSegment(object, {}, options).open);
  }
  SECTION("undefined") {
    CHECK_THROWS_AS(oracleSegment(object, object.box(), options), Undefined);
    CHECK_THROWS_AS(oracleSegment(object, boxAt({0, 0, 1}, {1, 1, 7}), options), Undefined);
    options.boundary = Boundary::open;
    CHECK_THROWS_AS(oracleSegment(object, {}, options), Undefined);
    options.boundary = Boundary::closed;
    CHECK_NOTHROW(oracleSegment(object, object.box(), options));
    CHECK_THROWS_AS(oracleSegment(object, boxAt({0, 0, 1}, {1, 1, 7}), options), Undefined);
    options.merge.theta = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(oracleSegment(object, {}, options), Undefined);
  }
}

TEST_CASE("oracle: the restriction of the candidates loses nothing", "[oracle]") {
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 6), rng.between(1, 6), rng.between(1, 6));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    const auto domain = randomDomain(object, rng);
    SegmentOptions options = merging(-0.9, MergeMode::both);
    VoxelWeights weights;
    if (seed % 2)
      options.weights = weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
    INFO("seed " << seed << ", " << name(kind) << ", " << weights.toString() << "\n"
                 << picture(object));
    OracleResult result;
    try {
      result = oracleSegment(object, domain, options);
    } catch (const Undefined&) {
      continue;
    }
    const auto squared = [&](const Coord& d) {
      int64_t sum = 0;
      for (int axis = 0; axis < 3; ++axis) sum += int64_t(weights[axis]) * d[axis] * d[axis];
      return sum;
    };
    CoordBBox universe = object.box();
    universe.expand(1);
    for (int i = 0; i < object.size(); ++i) {
      if (!object[i]) continue;
      const Coord p = object.coord(i);
      int64_t distance = std::numeric_limits<int64_t>::max();
      for (auto q = universe.begin(); q; ++q)
        if (!object.get(*q, 0) && (!domain || domain->isInside(*q)))
          distance = std::min(distance, squared(p - *q));
      REQUIRE(result.distance[i] == distance);

      int64_t power = std::numeric_limits<int64_t>::max(), radius = 0;
      int site = kNoSite;
      for (int x = 0; x < object.size(); ++x) {
        if (!object[x]) continue;
        const int64_t d = result.distance[x], pi = squared(p - object.coord(x)) - d;
        if (pi > power || (pi == power && d <= radius)) continue;
        power = pi;
        radius = d;
        site = x;
      }
      REQUIRE(result.unfiltered.site[i] == site);
      REQUIRE(result.unfiltered.power[i] == power);
    }
  }
}

TEST_CASE("oracle: volumes, pictures and grids agree", "[oracle]") {
  const ObjectVolume object = fromPicture("#.#/...|.../##.", {-1, 7, 8});
  CHECK(countObject(object) == 4);
  CHECK(object[Coord(-1, 7, 10)] == 1);
  CHECK(object[Coord(0, 8, 9)] == 1);
  CHECK(objectBox(object) == object.box());
  CHECK(toObject(*toMask(object)) == object);
  CHECK(withBox(withBox(object, boxAt({-3, 3, 3}, {9, 9, 9})), object.box()) == object);
  CHECK(translated(translated(object, {5, -6, 7}), {-5, 6, -7}) == object);

  AxisMap map{{2, 0, 1}, {false, true, false}};  // (x, y, z) -> (z, -x, y)
  const ObjectVolume turned = permuted(object, map);
  CHECK(turned[Coord(10, 1, 7)] == 1);
  CHECK(countObject(turned) == 4);

  Rng rng(7);
  const ObjectVolume leaves =
      randomVolume(VolumeKind::fullBlock, boxAt({-8, -9, 0}, {16, 17, 16}), rng);
  const auto tiled = toMask(leaves, Tiles::wherePossible);
  CHECK(tiled->tree().activeTileCount() == 8);
  CHECK(toObject(*tiled) == leaves);
}

TEST_CASE("oracle: a broken grid differs", "[oracle]") {
  const ObjectVolume object = fromPicture("##.");
  DenseVolume<int64_t> values(object.box());
  values[0] = 1;
  values[1] = 2;
  auto grid = toGrid(object, values);
  CHECK(difference("it", *grid, object, values).empty());
  grid->tree().setValueOn({0, 0, 1}, 3);
  CHECK(difference("it", *grid, object, values) == "it at [0, 0, 1]: 3, expected 2");
  grid = toGrid(object, values);
  grid->tree().setValueOff({0, 0, 1});
  CHECK_FALSE(difference("it", *grid, object, values).empty());
  grid = toGrid(object, values);
  grid->tree().setValueOn({0, 0, 2}, 0);
  CHECK_FALSE(difference("it", *grid, object, values).empty());
  grid = toGrid(object, values);
  grid->tree().setValueOn({100, 0, 2}, 1);
  CHECK_FALSE(difference("it", *grid, object, values).empty());
}
