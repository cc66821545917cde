// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Joining by score, against the oracle's, which looks at all pairs before each join.

#include "vdb_madf/method/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_graph.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using GrainNumbers = std::vector<int32_t>;

/// Nodes on the x axis: squared radii and voxels.
ManifoldGraph nodesOnAxis(const std::vector<std::pair<int, int64_t>>& nodes) {
  ManifoldGraph graph;
  for (const auto& [squaredRadius, voxels] : nodes)
    graph.nodes.push_back({{10 * int(graph.nodes.size()), 0, 0}, squaredRadius, voxels});
  return graph;
}

MergeOptions atStrictness(double strictness) {
  MergeOptions options;
  options.mode = MergeMode::score;
  options.strictness = strictness;
  return options;
}

/// As a set of sets.
bool refines(const GrainNumbers& fine, const GrainNumbers& coarse) {
  std::map<int32_t, int32_t> of;
  for (size_t i = 0; i < fine.size(); ++i) {
    if (fine[i] == 0) continue;  // no grain, which may become part of one
    if (of.emplace(fine[i], coarse[i]).first->second != coarse[i]) return false;
  }
  return true;
}

void requireSame(const Merging& a, const Merging& b) {
  REQUIRE(a.grainOfNode == b.grainOfNode);
  REQUIRE(a.representative == b.representative);
}

/// The same joins as the oracle's, and the same grains wherever the hierarchy is cut.
void requireOracles(const ManifoldGraph& graph) {
  const Hierarchy hierarchy = mergeHierarchy(graph);
  const OracleHierarchy expected = oracleHierarchy(graph);
  REQUIRE(hierarchy.joins.size() == expected.joins.size());
  for (size_t i = 0; i < expected.joins.size(); ++i) {
    CAPTURE(i);
    const Hierarchy::Join& join = hierarchy.joins[i];
    REQUIRE(join.score == expected.joins[i].score);
    REQUIRE(hierarchy.classes[join.first].representative == expected.joins[i].first);
    REQUIRE(hierarchy.classes[join.second].representative == expected.joins[i].second);
  }
  for (size_t i = 0; i < graph.nodes.size(); ++i)
    REQUIRE(hierarchy.classes[hierarchy.classOfNode[i]].representative == expected.classOf[i]);

  std::set<double> cuts{-kMaxStrictness, 10, 11, 12, kMaxStrictness};
  for (const Hierarchy::Join& join : hierarchy.joins)
    for (const int step : {0, 1}) cuts.insert((join.score + step) / 512.0);
  std::optional<Merging> coarser;
  for (const double k : cuts) {  // ascending
    CAPTURE(k);
    const Merging merging = cut(hierarchy, k);
    requireSame(merging, merge(graph, atStrictness(k)));
    requireSame(merging, mergeClasses(graph, oracleCut(graph, expected, k)));
    if (coarser) REQUIRE(refines(merging.grainOfNode, coarser->grainOfNode));
    coarser = merging;
  }
  requireSame(cut(hierarchy, 11), oracleMerge(graph, atStrictness(11)));
}

}  // namespace

TEST_CASE("hierarchy: nothing to join", "[hierarchy]") {
  CHECK(mergeHierarchy({}).classes.empty());
  CHECK(cut(mergeHierarchy({}), 11).grainOfNode.empty());
  requireOracles({});
  requireOracles(nodesOnAxis({{4, 30}}));
  requireOracles(nodesOnAxis({{4, 30}, {4, 30}, {9, 100}}));
  ManifoldGraph graph = nodesOnAxis({{4, 30}, {4, 30}});
  for (const int height : {0, -1}) {  // a contact without a neck
    graph.edges = {{0, 1, 10, height, false}};
    CHECK(mergeHierarchy(graph).joins.empty());
    requireOracles(graph);
  }
}

TEST_CASE("hierarchy: halves of a body join, grains with a neck do not", "[hierarchy]") {
  // Two balls of radius 10, some 4000 voxels. A broad contact: log2(4000 / 4000) + 9 +
  // 2.5 * 300 / 252 - 4 (10 - sqrt(99)) = 11.8. A narrow one, of radius 5: 9 + 0.8 - 20.
  ManifoldGraph graph = nodesOnAxis({{100, 4000}, {100, 4000}});
  graph.edges = {{0, 1, 300, 99, true}};
  CHECK(mergeHierarchy(graph).joins.at(0).score / 512.0 == Approx(11.8).margin(0.1));
  CHECK(merge(graph, atStrictness(11)).grainOfNode == GrainNumbers{1, 1});
  CHECK(merge(graph, atStrictness(12)).grainOfNode == GrainNumbers{1, 2});
  requireOracles(graph);
  graph.edges = {{0, 1, 78, 25, true}};
  CHECK(mergeHierarchy(graph).joins.at(0).score / 512.0 == Approx(-10.2).margin(0.1));
  CHECK(merge(graph, atStrictness(11)).grainOfNode == GrainNumbers{1, 2});
  requireOracles(graph);
}

TEST_CASE("hierarchy: what is no local maximum is part of a class from the beginning",
          "[hierarchy]") {
  ManifoldGraph graph = nodesOnAxis({{9, 50}, {4, 20}, {9, 60}});
  graph.edges = {{0, 1, 1, 3, true}, {1, 2, 1, 4, true}};
  const Hierarchy hierarchy = mergeHierarchy(graph);
  CHECK(hierarchy.classOfNode == std::vector<uint32_t>{0, 1, 1});
  REQUIRE(hierarchy.classes.size() == 2);
  CHECK(hierarchy.classes[1].representative == 2);
  CHECK(hierarchy.classes[1].top == 9);
  CHECK(hierarchy.classes[1].voxels == 80);
  CHECK(hierarchy.joins.size() == 1);
  requireOracles(graph);
}

TEST_CASE("hierarchy: of equal scores the pair with the smaller representatives", "[hierarchy]") {
  // A ring of four alike: 0-1 first; then 0 and 1 weigh more beside 2 and 3.
  ManifoldGraph graph = nodesOnAxis({{25, 500}, {25, 500}, {25, 500}, {25, 500}});
  graph.edges = {
      {0, 1, 40, 20, true}, {0, 3, 40, 20, true}, {1, 2, 40, 20, true}, {2, 3, 40, 20, true}};
  const Hierarchy hierarchy = mergeHierarchy(graph);
  REQUIRE(hierarchy.joins.size() == 3);
  CHECK(hierarchy.joins[0].first == 0);
  CHECK(hierarchy.joins[0].second == 1);
  requireOracles(graph);
  // All with all, of equal volumes: the names alone decide.
  graph.edges.clear();
  for (uint32_t a = 0; a < 4; ++a)
    for (uint32_t b = a + 1; b < 4; ++b) graph.edges.push_back({a, b, 40, 20, true});
  requireOracles(graph);
}

TEST_CASE("hierarchy: a join can make a larger score", "[hierarchy]") {
  // Two small ones beside a large one join each other, and their contacts with it add up.
  ManifoldGraph graph = nodesOnAxis({{30, 300}, {30, 300}, {400, 30000}});
  graph.edges = {{0, 1, 60, 16, true}, {0, 2, 1000, 16, true}, {1, 2, 1000, 16, true}};
  const Hierarchy hierarchy = mergeHierarchy(graph);
  REQUIRE(hierarchy.joins.size() == 2);
  CHECK(hierarchy.joins[0].second == 1);
  CHECK(hierarchy.joins[1].score > hierarchy.joins[0].score);
  requireOracles(graph);
}

TEST_CASE("hierarchy: a class without a voxel of the object is no grain", "[hierarchy]") {
  ManifoldGraph graph = nodesOnAxis({{30, 0}, {30, 0}, {25, 400}});
  graph.edges = {{1, 2, 3, 1, true}};
  CHECK(merge(graph, atStrictness(100)).grainOfNode == GrainNumbers{0, 0, 1});
  CHECK(merge(graph, atStrictness(-100)).grainOfNode == GrainNumbers{0, 1, 1});
  CHECK(merge(graph, atStrictness(-100)).representative == std::vector<uint32_t>{1});
  requireOracles(graph);
}

TEST_CASE("hierarchy: as the oracle joins, on random graphs", "[hierarchy]") {
  const char* cases = std::getenv("VDB_MADF_GRAPHS");
  const uint64_t count = cases ? std::stoull(cases) : 2000;
  size_t joins = 0, rises = 0, ties = 0;
  for (uint64_t seed = 1; seed <= count; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const ManifoldGraph graph = randomGraph(rng);
    requireOracles(graph);
    const Hierarchy hierarchy = mergeHierarchy(graph);
    joins += hierarchy.joins.size();
    for (size_t i = 1; i < hierarchy.joins.size(); ++i) {
      rises += hierarchy.joins[i].score > hierarchy.joins[i - 1].score;
      ties += hierarchy.joins[i].score == hierarchy.joins[i - 1].score;
    }
  }
  CHECK(joins > 5 * count);
  CHECK(rises > count / 10);
  CHECK(ties > count / 20);
}

TEST_CASE("hierarchy: tells the grains that each join leaves", "[hierarchy]") {
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const ManifoldGraph graph = randomGraph(rng);
    const Hierarchy hierarchy = mergeHierarchy(graph);
    const std::vector<JoinedGrains> joins = joinedGrains(hierarchy);
    REQUIRE(joins.size() == hierarchy.joins.size());
    for (size_t i = 0; i < joins.size(); ++i) {
      const JoinedGrains& join = joins[i];
      REQUIRE(join.strictness <= join.score);
      // The joins of the same strictness are made together.
      if (i + 1 < joins.size() && joins[i + 1].strictness == join.strictness) continue;
      const Merging at = cut(hierarchy, join.strictness);
      REQUIRE(int64_t(at.representative.size()) == join.grains);
      REQUIRE(at.grainOfNode[join.first] == at.grainOfNode[join.second]);
      if (at.grainOfNode[join.first] == 0) continue;
      const Merging before = cut(hierarchy, join.strictness + 1.0 / Hierarchy::kUnitsOfScore);
      const std::vector<int64_t> voxels = grainVoxels(graph, before);
      if (i > 0 && joins[i - 1].strictness == join.strictness) continue;
      const auto voxelsOf = [&](uint32_t node) {
        const int32_t grain = before.grainOfNode[node];
        return grain ? voxels[grain - 1] : 0;
      };
      REQUIRE(voxelsOf(join.first) == join.firstVoxels);
      REQUIRE(voxelsOf(join.second) == join.secondVoxels);
    }
  }
}

TEST_CASE("hierarchy: any sizes are joined, however large", "[hierarchy]") {
  Rng rng(3);
  constexpr int64_t kHuge = int64_t(1) << 62;
  for (int i = 0; i < 200; ++i) {
    ManifoldGraph graph = randomGraph(rng);
    for (ManifoldGraph::Node& node : graph.nodes) {
      node.voxels = rng.chance(0.3) ? kHuge : logarithmic(rng, 50);
      node.squaredRadius = rng.chance(0.3) ? 2147483647 : int32_t(2 + logarithmic(rng, 30.9));
      node.doubt = rng.chance(0.3) ? node.squaredRadius : 0;
    }
    for (ManifoldGraph::Edge& edge : graph.edges) {
      edge.contactFaces = rng.chance(0.3) ? kHuge : logarithmic(rng, 40);
      edge.saddleHeight = rng.chance(0.3) ? 2147483646 : int32_t(logarithmic(rng, 30.9));
    }
    const Hierarchy hierarchy = mergeHierarchy(graph);
    for (const Hierarchy::Join& join : hierarchy.joins) {
      CHECK(join.score <= (graph.flatAxis ? 89335 : 72953));
      CHECK(join.score > -94930000);
    }
    requireSame(cut(hierarchy, 11), merge(graph, atStrictness(11)));
  }
}

TEST_CASE("hierarchy: a class with many neighbors does not look at all of them each time",
          "[hierarchy]") {
  // It would take minutes, and gigabytes.
  ManifoldGraph graph;
  constexpr int kNeighbors = 100000;
  graph.nodes.push_back({{0, 0, 0}, 10000, 4000000});
  Rng rng(5);
  for (int i = 1; i <= kNeighbors; ++i) {
    graph.nodes.push_back({{i, 0, 0}, rng.between(4, 60), rng.between(1, 300)});
    graph.edges.push_back({0, uint32_t(i), rng.between(1, 40), rng.between(1, 3), true});
  }
  const Hierarchy hierarchy = mergeHierarchy(graph);
  REQUIRE(hierarchy.joins.size() == kNeighbors);
  CHECK(std::all_of(hierarchy.joins.begin(), hierarchy.joins.end(),
                    [](const Hierarchy::Join& join) { return join.first == 0; }));
}

TEST_CASE("hierarchy: of a graph that is given away it is the same", "[hierarchy]") {
  Rng rng(5);
  for (int i = 0; i < 50; ++i) {
    ManifoldGraph graph = randomGraph(rng);
    const Hierarchy kept = mergeHierarchy(graph, 4);
    const Hierarchy given = mergeHierarchy(std::move(graph), 4);
    CHECK(given.classOfNode == kept.classOfNode);
    REQUIRE(given.joins.size() == kept.joins.size());
    for (size_t j = 0; j < kept.joins.size(); ++j) {
      CHECK(given.joins[j].first == kept.joins[j].first);
      CHECK(given.joins[j].second == kept.joins[j].second);
      CHECK(given.joins[j].score == kept.joins[j].score);
    }
  }
}

TEST_CASE("hierarchy: a strictness is rounded to the nearest unit", "[hierarchy]") {
  ManifoldGraph graph = nodesOnAxis({{100, 4000}, {100, 4000}});
  graph.edges = {{0, 1, 300, 99, true}};
  const Hierarchy hierarchy = mergeHierarchy(graph);
  const double unit = 1 / 512.0, exact = hierarchy.joins.at(0).score * unit;
  for (const double k : {exact, exact + 0.49 * unit, exact - 0.5 * unit})
    CHECK(cut(hierarchy, k).grainOfNode == GrainNumbers{1, 1});
  for (const double k : {exact + 0.5 * unit, exact + unit, kMaxStrictness})
    CHECK(cut(hierarchy, k).grainOfNode == GrainNumbers{1, 2});
}

TEST_CASE("hierarchy: is cut where it has joins", "[hierarchy]") {
  ManifoldGraph graph = nodesOnAxis({{100, 4000}, {100, 4000}});
  graph.edges = {{0, 1, 78, 25, true}};
  const Hierarchy hierarchy = mergeHierarchy(graph, 9.5);
  CHECK(hierarchy.joins.empty());
  CHECK(cut(hierarchy, 9.5).representative.size() == 2);
  CHECK_THROWS_AS(cut(hierarchy, 9.4), InvalidInput);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double k : {std::nan(""), inf, -inf, 200001.0, -200001.0}) {
    CHECK_THROWS_AS(mergeHierarchy(graph, k), InvalidInput);
    CHECK_THROWS_AS(cut(hierarchy, k), InvalidInput);
    CHECK_THROWS_AS(merge(graph, atStrictness(k)), InvalidInput);
    CHECK_THROWS_AS(merge({}, atStrictness(k)), InvalidInput);
  }
}
