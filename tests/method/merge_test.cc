// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Every hand-drawn case is put to the oracle's merge, too: the oracle answers for itself here.

#include "vdb_madf/method/merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using NodeLabels = std::vector<int32_t>;
using Nodes = std::vector<uint32_t>;

/// Balls on the x axis: positions and squared radii.
ManifoldGraph ballsOnAxis(const std::vector<std::pair<int, int>>& balls) {
  ManifoldGraph graph;
  for (const auto& [x, squaredRadius] : balls) graph.nodes.push_back({{x, 0, 0}, squaredRadius, 1});
  return graph;
}

void connect(ManifoldGraph& graph, uint32_t first, uint32_t second, int saddleHeight,
             bool cellsTouch = true) {
  graph.edges.push_back({first, second, 1, saddleHeight, cellsTouch});
}

MergeOptions options(double theta, MergeMode mode, Adjacency adjacency = Adjacency::manifold) {
  return {mode, 11, theta, 0, adjacency};
}

void checkMerge(const ManifoldGraph& graph, const MergeOptions& merging, const NodeLabels& labels,
                const Nodes& representatives) {
  const Merging result = merge(graph, merging), expected = oracleMerge(graph, merging);
  CHECK(result.grainOfNode == labels);
  CHECK(result.representative == representatives);
  CHECK(expected.grainOfNode == labels);
  CHECK(expected.representative == representatives);
}

}  // namespace

TEST_CASE("merge: no nodes, no grains", "[merge]") {
  for (const MergeMode mode : {MergeMode::both, MergeMode::angle, MergeMode::neck})
    checkMerge({}, options(1, mode), {}, {});
}

TEST_CASE("merge: nodes without edges stay alone", "[merge]") {
  for (const MergeMode mode : {MergeMode::both, MergeMode::angle, MergeMode::neck})
    checkMerge(ballsOnAxis({{0, 4}, {1, 4}, {2, 9}}), options(1, mode), {1, 2, 3}, {0, 1, 2});
}

TEST_CASE("merge: the angle must be strictly below theta", "[merge]") {
  // Two balls of D = 4, 2 apart: cos = (4 - 8) / 8 = -0.5, exact in binary.
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {2, 4}});
  connect(graph, 0, 1, 3);
  checkMerge(graph, options(-0.5, MergeMode::angle), {1, 2}, {0, 1});
  checkMerge(graph, options(std::nextafter(-0.5, 0.0), MergeMode::angle), {1, 1}, {0});
  checkMerge(graph, options(std::nextafter(-0.5, -1.0), MergeMode::angle), {1, 2}, {0, 1});
}

TEST_CASE("merge: the angle is computed in double precision as written", "[merge]") {
  // D = 5 and 10, |ci - cj|^2 = 5: cos = -10 / (2 sqrt(50)) = -0.70710678118654752...: the nearest
  // double to theta must be told from its neighbors.
  ManifoldGraph graph;
  graph.nodes = {{{0, 0, 0}, 5, 1}, {{1, 2, 0}, 10, 1}};
  connect(graph, 0, 1, 0);
  const double cosine = -10.0 / (2 * std::sqrt(50.0));
  checkMerge(graph, options(cosine, MergeMode::angle), {1, 2}, {0, 1});
  checkMerge(graph, options(std::nextafter(cosine, 0.0), MergeMode::angle), {1, 1}, {1});
}

TEST_CASE("merge: large radii do not overflow", "[merge]") {
  // D = 2^30 and two balls 2^15 apart: |ci - cj|^2 = 2^30; cos = (2^30 - 2^31) / 2^31 = -0.5.
  const int squaredRadius = 1 << 30;
  ManifoldGraph graph = ballsOnAxis({{0, squaredRadius}, {1 << 15, squaredRadius}});
  connect(graph, 0, 1, squaredRadius / 2);
  checkMerge(graph, options(-0.5, MergeMode::angle), {1, 2}, {0, 1});
  checkMerge(graph, options(-0.49, MergeMode::angle), {1, 1}, {0});
  checkMerge(graph, options(0, MergeMode::neck), {1, 1}, {0});  // 2^29 >= 0.5 * 2^30
  checkMerge(graph, options(-0.01, MergeMode::neck), {1, 2}, {0, 1});
  // Far apart: the cosine is beyond 1, no theta merges.
  ManifoldGraph far = ballsOnAxis({{0, 1}, {26753, 1}});
  connect(far, 0, 1, -100);
  checkMerge(far, options(1, MergeMode::both), {1, 2}, {0, 1});
}

TEST_CASE("merge: angle merges are transitive, on the original balls", "[merge]") {
  // Neighbors 1 apart with D = 4: cos = (1 - 8) / 8 = -0.875; the ends are not tested at all.
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {1, 4}, {2, 4}, {9, 4}});
  connect(graph, 0, 1, 1);
  connect(graph, 1, 2, 1);
  connect(graph, 2, 3, 1);  // cos = (49 - 8) / 8 > 1
  checkMerge(graph, options(-0.8, MergeMode::angle), {1, 1, 1, 2}, {0, 3});
}

TEST_CASE("merge: theta -1 merges nothing by angle", "[merge]") {
  // 1 apart with D = 4 and 1: touching from inside, cos = (1 - 5) / 4 = -1.
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {1, 1}});
  connect(graph, 0, 1, 0);
  checkMerge(graph, options(-1, MergeMode::angle), {1, 2}, {0, 1});
  checkMerge(graph, options(std::nextafter(-1.0, 0.0), MergeMode::angle), {1, 1}, {0});
}

TEST_CASE("merge: theta -1 merges a node that is no local maximum of the height", "[merge]") {
  // The neck is as high as the lower of the two: factor 1.
  ManifoldGraph graph = ballsOnAxis({{0, 9}, {3, 4}, {6, 9}});
  connect(graph, 0, 1, 4);
  connect(graph, 1, 2, 3);
  checkMerge(graph, options(-1, MergeMode::neck), {1, 1, 2}, {0, 2});
  checkMerge(graph, options(-1, MergeMode::both), {1, 1, 2}, {0, 2});
}

TEST_CASE("merge: the neck must reach its share of the lower top, or more", "[merge]") {
  // theta -0.5: factor 0.75; 0.75 * 8 = 6.
  for (const int height : {5, 6, 7}) {
    ManifoldGraph graph = ballsOnAxis({{0, 8}, {5, 16}});
    connect(graph, 0, 1, height);
    if (height < 6)
      checkMerge(graph, options(-0.5, MergeMode::neck), {1, 2}, {0, 1});
    else
      checkMerge(graph, options(-0.5, MergeMode::neck), {1, 1}, {1});
  }
}

TEST_CASE("merge: necks of no height never merge", "[merge]") {
  // theta 1: factor 0, so every h > 0 merges.
  for (const int height : {-3, 0, 1}) {
    ManifoldGraph graph = ballsOnAxis({{0, 9}, {100, 9}});
    connect(graph, 0, 1, height);
    if (height <= 0)
      checkMerge(graph, options(1, MergeMode::neck), {1, 2}, {0, 1});
    else
      checkMerge(graph, options(1, MergeMode::neck), {1, 1}, {0});
  }
}

TEST_CASE("merge: necks are visited from the highest down, and tops grow", "[merge]") {
  // theta -0.6: factor 0.8. D = 10, 10, 100 in a row.
  SECTION("the small one joins the large one first: its top is then 100") {
    ManifoldGraph graph = ballsOnAxis({{0, 10}, {10, 10}, {20, 100}});
    connect(graph, 0, 1, 8);   // second: 8 >= 0.8 * min(10, 100)
    connect(graph, 1, 2, 10);  // first: 10 >= 0.8 * min(10, 100)
    checkMerge(graph, options(-0.6, MergeMode::neck), {1, 1, 1}, {2});
  }
  SECTION("two large ones do not meet over a small one") {
    // D = 100, 10, 100: 9 >= 8 joins node 1 to the left, and then 8 < 0.8 * min(100, 100).
    ManifoldGraph graph = ballsOnAxis({{0, 100}, {20, 10}, {40, 100}});
    connect(graph, 0, 1, 9);
    connect(graph, 1, 2, 8);
    checkMerge(graph, options(-0.6, MergeMode::neck), {1, 1, 2}, {0, 2});
    // ... and to the right, if that neck is the higher one.
    std::swap(graph.edges[0].saddleHeight, graph.edges[1].saddleHeight);
    checkMerge(graph, options(-0.6, MergeMode::neck), {1, 2, 2}, {0, 2});
  }
  SECTION("equal necks: the pair with the smaller first node, then the smaller second") {
    ManifoldGraph graph = ballsOnAxis({{0, 100}, {20, 10}, {40, 100}});
    connect(graph, 0, 1, 9);
    connect(graph, 1, 2, 9);
    checkMerge(graph, options(-0.6, MergeMode::neck), {1, 1, 2}, {0, 2});
    // Node 0 is the small one between 1 and 2.
    graph = ballsOnAxis({{0, 10}, {20, 100}, {40, 100}});
    connect(graph, 0, 1, 9);
    connect(graph, 0, 2, 9);
    checkMerge(graph, options(-0.6, MergeMode::neck), {1, 1, 2}, {1, 2});
  }
}

TEST_CASE("merge: tops include what the angle merged", "[merge]") {
  // Nodes 0 and 1 (D = 100, 81; 2 apart: cos = (4 - 181) / 180 = -0.983) merge by angle at -0.9;
  // the neck between 1 and 2 is tested with top 100, not 81.
  ManifoldGraph graph = ballsOnAxis({{0, 100}, {2, 81}, {30, 100}});
  connect(graph, 0, 1, 1);
  connect(graph, 1, 2, 90);
  // 0.95 * 81 = 76.95 <= 90 < 95 = 0.95 * 100
  checkMerge(graph, options(-0.9, MergeMode::neck), {1, 2, 2}, {0, 2});
  checkMerge(graph, options(-0.9, MergeMode::both), {1, 1, 2}, {0, 2});
  checkMerge(graph, options(-0.9, MergeMode::angle), {1, 1, 2}, {0, 2});
}

TEST_CASE("merge: adjacency of cells restricts the angle test only", "[merge]") {
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {1, 4}, {2, 4}});
  connect(graph, 0, 1, 1, false);  // cos = -0.875
  connect(graph, 1, 2, 1, true);
  checkMerge(graph, options(-0.8, MergeMode::angle, Adjacency::manifold), {1, 1, 1}, {0});
  checkMerge(graph, options(-0.8, MergeMode::angle, Adjacency::cell), {1, 2, 2}, {0, 1});
  graph.edges[0].saddleHeight = 4;
  checkMerge(graph, options(-0.8, MergeMode::neck, Adjacency::cell), {1, 1, 2}, {0, 2});
  checkMerge(graph, options(-0.8, MergeMode::both, Adjacency::cell), {1, 1, 1}, {0});
}

TEST_CASE("merge: a neck that is narrower by less than delta merges", "[merge]") {
  // sqrt(100) - sqrt(81) = 1 voxel: 8 eighths. Strictly less.
  ManifoldGraph graph = ballsOnAxis({{0, 100}, {20, 144}});
  connect(graph, 0, 1, 81);
  for (const MergeMode mode : {MergeMode::neck, MergeMode::both}) {
    MergeOptions merging = options(-1, mode);
    for (const int delta : {0, 2, 8}) {
      merging.delta = delta;
      checkMerge(graph, merging, {1, 2}, {0, 1});
    }
    for (const int delta : {9, 80}) {
      merging.delta = delta;
      checkMerge(graph, merging, {1, 1}, {1});
    }
  }
  MergeOptions angle = options(-1, MergeMode::angle);
  angle.delta = 80;
  checkMerge(graph, angle, {1, 2}, {0, 1});
}

TEST_CASE("merge: angles and delta are those of the weights", "[merge]") {
  // On the axis of weight 9, 1 voxel: 3 lengths of balls of radius 2: cos = (9 - 4 - 4) / 8.
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {1, 4}});
  connect(graph, 0, 1, 1);
  checkMerge(graph, options(-0.7, MergeMode::angle), {1, 1}, {0});
  graph.weights = {9, 9, 9};
  checkMerge(graph, options(0.125, MergeMode::angle), {1, 2}, {0, 1});
  checkMerge(graph, options(0.13, MergeMode::angle), {1, 1}, {0});
  // sqrt(400) - sqrt(324) = 2 is the shortest edge, the root of 4: 8 eighths.
  graph = ballsOnAxis({{0, 400}, {20, 500}});
  connect(graph, 0, 1, 324);
  for (const VoxelWeights& weights :
       {VoxelWeights{4, 9, 25}, VoxelWeights{9, 4, 25}, VoxelWeights{25, 9, 4}}) {
    graph.weights = weights;
    MergeOptions merging = options(-1, MergeMode::neck);
    merging.delta = 8;
    checkMerge(graph, merging, {1, 2}, {0, 1});
    merging.delta = 9;
    checkMerge(graph, merging, {1, 1}, {1});
  }
}

TEST_CASE("merge: delta sees tops as they grow, and no neck without height", "[merge]") {
  // Node 1 (D = 16) joins node 0 (D = 100) at h = 16; then 16 is far below 100.
  ManifoldGraph graph = ballsOnAxis({{0, 100}, {20, 16}, {40, 100}});
  connect(graph, 0, 1, 16);
  connect(graph, 1, 2, 15);
  MergeOptions merging = options(-1, MergeMode::neck);
  merging.delta = 2;  // sqrt(16) - sqrt(15) = 0.127 voxels would pass
  checkMerge(graph, merging, {1, 1, 2}, {0, 2});
  graph.edges[0].saddleHeight = 0;
  graph.edges[1].saddleHeight = -1;
  merging.delta = kMaxDelta;  // 4 - 0 < 10
  checkMerge(graph, merging, {1, 2, 3}, {0, 1, 2});
}

TEST_CASE("merge: delta at the largest radii", "[merge]") {
  // L is near 2^31 and beyond, where its square would not fit.
  const int top = 26754 * 26754;
  for (const int height :
       {1, 1000000, top / 2, top - 600000, top - 535000, top - 534000, top - 1}) {
    ManifoldGraph graph = ballsOnAxis({{0, top}, {1000, top}});
    connect(graph, 0, 1, height);
    for (const int delta : {1, 2, 79, 80}) {
      MergeOptions merging = options(-1, MergeMode::neck);
      merging.delta = delta;
      for (const int edge : {1, 100, 30000}) {
        graph.weights = {edge * edge, edge * edge + 1, edge * edge};
        const long double narrower = std::sqrt((long double)top) - std::sqrt((long double)height);
        CAPTURE(height, delta, edge);
        if (narrower < edge * delta / 8.0L)
          checkMerge(graph, merging, {1, 1}, {0});
        else
          checkMerge(graph, merging, {1, 2}, {0, 1});
      }
    }
  }
}

TEST_CASE("merge: a class without a voxel of the object is no grain", "[merge]") {
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {10, 9}, {20, 5}, {30, 5}});
  graph.nodes[0].voxels = graph.nodes[1].voxels = 0;
  connect(graph, 1, 2, 5);
  // Node 0 alone has none; 1 and 2 are one grain, represented by node 1.
  checkMerge(graph, options(-1, MergeMode::neck), {0, 1, 1, 2}, {1, 3});
  CHECK(grainVoxels(graph, merge(graph, options(-1, MergeMode::neck))) ==
        std::vector<int64_t>{1, 1});
}

TEST_CASE("merge: grains are numbered by their representatives", "[merge]") {
  // {0, 3} has its largest ball at 3, {1, 2} at 1 (equal to 2: smaller coordinate).
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {10, 9}, {20, 9}, {30, 5}});
  connect(graph, 0, 3, 4);
  connect(graph, 1, 2, 9);
  checkMerge(graph, options(-1, MergeMode::neck), {2, 1, 1, 2}, {1, 3});
}

TEST_CASE("merge: theta outside [-1, 1] is refused", "[merge]") {
  ManifoldGraph graph = ballsOnAxis({{0, 4}});
  const double inf = std::numeric_limits<double>::infinity();
  for (const double theta :
       {std::nan(""), inf, -inf, std::nextafter(1.0, 2.0), std::nextafter(-1.0, -2.0)})
    for (const MergeMode mode : {MergeMode::both, MergeMode::angle, MergeMode::neck}) {
      CHECK_THROWS_AS(merge(graph, options(theta, mode)), InvalidInput);
      CHECK_THROWS_AS(merge({}, options(theta, mode)), InvalidInput);
    }
  for (const int delta : {-1, kMaxDelta + 1})
    CHECK_THROWS_AS(merge(graph, {MergeMode::both, 11, -0.9, delta, Adjacency::manifold}),
                    InvalidInput);
}

TEST_CASE("merge: agrees with the oracle on random graphs", "[merge]") {
  // Few different radii, heights and positions: many ties.
  for (uint64_t seed = 1; seed <= 4000; ++seed) {
    Rng rng(seed);
    std::set<Coord> positions;
    const int side = rng.between(2, 12), count = rng.between(1, 24), radii = rng.between(1, 20);
    for (int i = 0; i < count; ++i)
      positions.insert({rng.below(side), rng.below(side), rng.below(side)});
    ManifoldGraph graph;
    const double empty = rng.chance(0.2) ? 0.3 : 0;  // nodes without voxels of the object
    for (const Coord& p : positions)
      graph.nodes.push_back({p, 1 + rng.below(radii), rng.chance(empty) ? 0 : 1});
    const double density = rng.unit();
    for (uint32_t a = 0; a < graph.nodes.size(); ++a)
      for (uint32_t b = a + 1; b < graph.nodes.size(); ++b) {
        if (!rng.chance(density)) continue;
        const int lower = std::min(graph.nodes[a].squaredRadius, graph.nodes[b].squaredRadius);
        connect(graph, a, b, rng.between(-2, lower), rng.chance(0.7));
      }
    const double thetas[] = {-1, -0.95, -0.9, -0.8, -0.5, 0, 0.5, 1, 2 * rng.unit() - 1};
    if (rng.chance(0.5)) graph.weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
    MergeOptions merging = options(thetas[rng.below(9)], MergeMode(rng.below(3)),
                                   rng.chance(0.5) ? Adjacency::cell : Adjacency::manifold);
    merging.delta = rng.chance(0.5) ? 0 : rng.between(0, kMaxDelta);
    const Merging result = merge(graph, merging), expected = oracleMerge(graph, merging);
    INFO("seed " << seed);
    REQUIRE(result.grainOfNode == expected.grainOfNode);
    REQUIRE(result.representative == expected.representative);
  }
}

TEST_CASE("merge: classes of one's own are numbered as merge() numbers grains", "[merge]") {
  ManifoldGraph graph = ballsOnAxis({{0, 4}, {5, 9}, {10, 9}, {15, 1}});
  const auto check = [&](const Nodes& classes, const NodeLabels& labels,
                         const Nodes& representatives) {
    const Merging merging = mergeClasses(graph, classes);
    CHECK(merging.grainOfNode == labels);
    CHECK(merging.representative == representatives);
  };
  check({0, 0, 0, 0}, {1, 1, 1, 1}, {1});           // of equal D the first
  check({4, 3, 2, 1}, {1, 2, 3, 4}, {0, 1, 2, 3});  // in the order of their representatives
  check({2, 0, 2, 0}, {2, 1, 2, 1}, {1, 2});        // classes need not touch
  graph.nodes[3].voxels = 0;                        // in a cavity
  check({0, 0, 0, 1}, {1, 1, 1, 0}, {1});
  check({1, 0, 0, 1}, {1, 2, 2, 1}, {0, 1});
  CHECK_THROWS_AS(mergeClasses(graph, {0, 0, 0}), InvalidInput);
  CHECK_THROWS_AS(mergeClasses(graph, {0, 0, 0, 5}), InvalidInput);
  CHECK(mergeClasses({}, {}).representative.empty());
}
