// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Joining by score, against the oracle's, which looks at all pairs before each join.

#include "vdb_madf/method/hierarchy.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/join_score.h"
#include "vdb_madf/method/grain_lives.h"
#include "vdb_madf/method/stable_strictness.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::detail::JoinScore;
using GrainNumbers = std::vector<int32_t>;

/// Of a pair of classes.
struct Case {
  int64_t voxelsA;
  int32_t topA;
  int64_t voxelsB;
  int32_t topB;
  int64_t faces;
  int32_t height;
};

int32_t score(const Case& c, const VoxelWeights& weights = {},
              const std::optional<int>& flatAxis = {}) {
  return JoinScore(weights, flatAxis)({c.voxelsA, c.topA, c.topA}, {c.voxelsB, c.topB, c.topB},
                                      c.faces, c.height);
}
int64_t slowScore(const Case& c, const VoxelWeights& weights = {}) {
  return oracleScore(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weights);
}

int64_t slowPlaneScore(const Case& c, int weightX = 1, int weightY = 1) {
  return oraclePlaneScore(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weightX,
                          weightY);
}

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

/// A logarithmic number up to a largest one.
int64_t logarithmic(Rng& rng, double bits) {
  return int64_t(std::exp2(rng.unit() * bits));
}

/// Few different radii, sizes, faces and heights: many ties.
ManifoldGraph randomGraph(Rng& rng) {
  std::set<Coord> positions;
  const bool alike = rng.chance(0.3);
  const int side = rng.between(2, 12), count = rng.between(1, 24),
            radii = alike ? 1 + rng.below(2) : rng.between(1, 30),
            sizes = alike ? 1 + rng.below(2) : rng.between(1, 200),
            faces = alike ? 1 + rng.below(2) : rng.between(1, 60);
  const bool anySize = !alike && rng.chance(0.3);
  for (int i = 0; i < count; ++i)
    positions.insert({rng.below(side), rng.below(side), rng.below(side)});
  ManifoldGraph graph;
  const double empty = rng.chance(0.2) ? 0.3 : 0;   // nodes without voxels of the object
  const double hollow = rng.chance(0.3) ? 0.3 : 0;  // nodes with voxels in cavities
  for (const Coord& p : positions)
    graph.nodes.push_back({p, 2 + rng.below(radii),
                           rng.chance(empty) ? 0
                           : anySize         ? logarithmic(rng, 16)
                                             : 1 + rng.below(sizes),
                           rng.chance(hollow) ? rng.below(20) : 0});
  const double density = rng.unit() * rng.unit(), steep = rng.chance(0.3) ? rng.unit() : 0;
  for (uint32_t a = 0; a < graph.nodes.size(); ++a)
    for (uint32_t b = a + 1; b < graph.nodes.size(); ++b) {
      if (!rng.chance(density)) continue;
      int highest = std::min(graph.nodes[a].squaredRadius, graph.nodes[b].squaredRadius);
      if (!rng.chance(steep)) --highest;  // few are no local maximum
      graph.edges.push_back({a, b, 1 + rng.below(faces), rng.between(-2, highest), false});
    }
  if (rng.chance(0.2)) graph.weights = {rng.between(1, 9), rng.between(1, 9), rng.between(1, 9)};
  if (rng.chance(0.3)) graph.flatAxis = rng.below(3);
  const double doubtful = rng.chance(0.5) ? rng.unit() : 0;
  for (ManifoldGraph::Node& node : graph.nodes)
    if (rng.chance(doubtful))
      node.doubt = rng.chance(0.7) ? node.squaredRadius : rng.below(node.squaredRadius);
  return graph;
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

TEST_CASE("hierarchy: logarithms and roots are floors", "[hierarchy]") {
  // A logarithm that never falls is a floor if it is one on either side of each step.
  int64_t last = 0;
  for (int step = 1; step < 43 * 256; ++step) {
    const long double power = std::exp2((long double)step / 256);
    const auto n = int64_t(std::ceil(power));
    if (step % 256 != 0) REQUIRE(n - power > 1e-6L);  // long double is sure enough
    if (step % 256 != 0) REQUIRE(power - (n - 1) > 1e-6L);
    CAPTURE(step, n);
    if (n == last) continue;  // several steps below one integer
    last = n;
    const auto highest = int64_t(std::floor(256 * std::log2((long double)n)));
    REQUIRE(detail::lg(n) == highest);
    if (n > 1) REQUIRE(detail::lg(n - 1) < step);
  }
  CHECK(detail::lg(1) == 0);
  CHECK(detail::lg(2) == 256);
  CHECK(detail::lg(3) == 405);
  CHECK(detail::lg(18) == 1067);
  CHECK(detail::lg(128) == 1792);
  CHECK(detail::lg(JoinScore::kMaxVoxels) == 11007);
  for (int64_t root : {0, 1, 2, 3, 255, 256, 65535, 65536, 11863282, (1 << 24) - 1}) {
    CHECK(detail::squareRoot(root * root) == root);
    CHECK(detail::squareRoot(root * root + root) == root);
    CHECK(detail::squareRoot(root * root + 2 * root) == root);
  }
}

TEST_CASE("hierarchy: scores, as integers of any size give them", "[hierarchy]") {
  const std::vector<std::pair<Case, int32_t>> cases = {
      {{1, 2, 1, 2, 1, 1}, 10416},
      {{1, 2, 1, 2, 0, 1}, 9136},
      {{1, 2, 8796093022207, 2147483647, 2147483647, 1}, 32992},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, -94893158},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 2147483646}, 11058},
      {{8796093022207, 2147483647, 1, 2147483647, 2147483647, 1}, -94880667},
      {{1, 2147483647, 8796093022207, 2147483647, 0, 1}, -94872218},
      {{1, 2147483647, 1, 2147483647, 0, 1}, -94894232},
      {{1, 2147483647, 1, 2147483647, 2147483647, 2147483646}, 50939},
      {{1, 2, 8796093022207, 2147483647, 0, 1}, 26542},
      {{8796093022207, 2, 8796093022207, 2, 2147483647, 1}, 21034},
      {{8796093022207, 2, 1, 2, 2147483647, 1}, 23725},
      {{8796093022207, 2, 8796093022207, 2, 0, 1}, 4784},
      {{1, 2, 8796093022207, 2, 2147483647, 1}, 47400},
      {{8796093022207, 2147483646, 8796093022207, 2147483647, 1, 1073741823}, -27792818},
      {{4398046511104, 715776516, 4398046511105, 715776516, 1000000000, 715723009}, 7325},
      {{127, 9, 500, 16, 12, 8}, 4568},
      {{128, 9, 500, 16, 12, 8}, 4559},
      {{129, 9, 500, 16, 12, 8}, 4559},
      {{4096, 100, 4096, 100, 300, 99}, 6004},
      {{20000, 100, 20000, 100, 314, 99}, 6898},
      {{20000, 100, 20000, 101, 314, 90}, 5910},
      {{3000, 144, 90000, 400, 150, 60}, -3272},
      {{65536, 225, 65537, 225, 700, 224}, 6945},
      {{99999, 81, 1000000, 10000, 99, 80}, 3028},
      {{5, 3, 7, 3, 2, 2}, 8497},
      {{7, 5, 7, 5, 4, 3}, 8193},
      {{1000, 64, 1000, 64, 8191, 50}, 43659},
      {{33554432, 46340, 33554431, 46341, 1, 12345}, -208732},
  };
  for (const auto& [c, expected] : cases) {
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height);
    CHECK(score(c) == expected);
    CHECK(slowScore(c) == expected);
  }
  const std::vector<std::pair<std::pair<Case, VoxelWeights>, int32_t>> unequal = {
      {{{4096, 2500, 4096, 2600, 300, 2400}, {25, 25, 144}}, 7248},
      {{{1, 2, 3, 3, 1, 1}, {1, 1, 400}}, 10380},
      {{{3, 2, 3, 3, 0, 1}, {1, 1, 400}}, 7885},
      {{{5000, 90000, 6000, 1000000, 100, 45000}, {100000, 9, 77}}, -58105},
      {{{4096, 400, 4096, 404, 300, 396}, {4, 4, 4}}, 5968},
      {{{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, {400000, 1, 400001}},
       -94882334},
  };
  for (const auto& [c, expected] : unequal) {
    CAPTURE(c.first.voxelsA, c.first.topA, c.second.toString());
    CHECK(score(c.first, c.second) == expected);
    CHECK(slowScore(c.first, c.second) == expected);
  }
}

TEST_CASE("hierarchy: a top that is not sure is what fits the neighbor", "[hierarchy]") {
  const JoinScore score({}, {});
  const auto of = [&](int32_t topA, int32_t sureA, int32_t topB, int32_t sureB, int height,
                      int64_t voxelsB = 5000) {
    return score({5000, topA, sureA}, {voxelsB, topB, sureB}, 200, height);
  };
  const auto known = [&](int32_t topA, int32_t topB, int height, int64_t voxelsB = 5000) {
    return of(topA, topA, topB, topB, height, voxelsB);
  };
  // The end of a rod, whose ball is larger than those within it, is no grain for its radius.
  CHECK(of(100, 100, 200, 0, 98) == known(100, 100, 98));
  CHECK(of(100, 100, 121, 110, 98) == known(100, 110, 98));            // some ball of it is known
  CHECK(of(100, 100, 200, 0, 98, 5001) == known(100, 200, 98, 5001));  // it is no end
  CHECK(of(100, 0, 121, 121, 60) == known(100, 121, 60));
  // Nothing is sure of either.
  CHECK(of(100, 0, 121, 95, 60) == known(95, 95, 60));
  CHECK(of(100, 0, 121, 95, 98) == known(98, 98, 98));
  CHECK(of(100, 99, 121, 95, 60) == known(99, 99, 60));
  CHECK(of(100, 0, 121, 0, 60) == known(90, 90, 60));
  CHECK(of(100, 0, 121, 0, 60, 5001) == known(90, 121, 60, 5001));
}

TEST_CASE("hierarchy: scores in a plane", "[hierarchy]") {
  const std::vector<std::pair<Case, int32_t>> cases = {
      {{1, 2, 1, 2, 1, 1}, 8174},
      {{1, 2, 1, 2, 0, 1}, 6638},
      {{1, 2, 8796093022207, 2147483647, 2147483647, 1}, 84709},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1}, -59260357},
      {{8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 2147483646}, 54778},
      {{8796093022207, 2147483647, 1, 2147483647, 2147483647, 1}, -59293378},
      {{1, 2147483647, 8796093022207, 2147483647, 0, 1}, -59274946},
      {{1, 2147483647, 1, 2147483647, 2147483647, 2147483646}, 56314},
      {{8796093022207, 2, 8796093022207, 2, 2147483647, 1}, 54248},
      {{63, 9, 500, 16, 6, 8}, 7124},
      {{64, 9, 500, 16, 6, 8}, 7112},
      {{65, 9, 500, 16, 6, 8}, 7112},
      {{400, 100, 400, 100, 20, 99}, 6491},
      {{4000, 100, 4000, 100, 20, 99}, 6533},
      {{1600, 100, 3000, 100, 20, 90}, 6784},
      {{900, 144, 9000, 400, 15, 60}, 1045},
      {{65536, 225, 65537, 225, 30, 224}, 5941},
      {{1000, 64, 1000, 64, 8191, 50}, 53588},
  };
  for (const auto& [c, expected] : cases) {
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height);
    CHECK(slowPlaneScore(c) == expected);
    // The edge along the flat axis does not count.
    for (const int axis : {0, 1, 2}) {
      VoxelWeights weights;
      (axis == 0 ? weights.x : axis == 1 ? weights.y : weights.z) = 7;
      CHECK(score(c, {}, axis) == expected);
      CHECK(score(c, weights, axis) == expected);
    }
  }
  CHECK(score({4096, 2500, 4096, 2600, 30, 2400}, {25, 9, 144}, 1) == 6732);
  CHECK(score({1, 2, 3, 3, 1, 1}, {3, 1, 400}, 0) == 8871);
  CHECK(score({5000, 90000, 6000, 1000000, 100, 45000}, {9, 77, 2}, 2) == -34098);
  CHECK(score({400, 400, 400, 404, 20, 396}, {4, 1, 4}, 1) == 6453);
  CHECK(score({8796093022207, 2147483647, 8796093022207, 2147483647, 2147483647, 1},
              {400000, 400001, 1}, 2) == -39007);

  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto top = [&] { return int32_t(1 + logarithmic(rng, 30.9)); };
    const auto [topA, topB] = std::minmax({top(), top()});
    const Case c{logarithmic(rng, 42.9),     topA,
                 logarithmic(rng, 42.9),     topB,
                 logarithmic(rng, 30.9) - 1, std::max(1, int32_t(topA * rng.unit()))};
    const int x = i % 2 ? rng.between(1, 30) : 1, y = i % 2 ? rng.between(1, 30) : 1;
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, x, y);
    const int32_t whole = score(c, {x, y, 1}, 2);
    REQUIRE(whole == slowPlaneScore(c, x, y));
    Case larger = c;
    larger.voxelsB = std::min(c.voxelsB + logarithmic(rng, 42.9), JoinScore::kMaxVoxels);
    REQUIRE(score(larger, {x, y, 1}, 2) - 3 * detail::lg(larger.voxelsB) <=
            whole - 3 * detail::lg(c.voxelsB));
  }
}

TEST_CASE("hierarchy: a rod in a plane joins, however long its pieces are", "[hierarchy]") {
  for (int radius = 2; radius < 400; radius += 1 + radius / 5)
    for (double first = radius; first < 2e6; first *= 1.7)
      for (double second = first; second < 2e6; second *= 1.7) {
        const int width = 2 * radius;
        CAPTURE(radius, first, second);
        REQUIRE(score({int64_t(first * width), radius * radius, int64_t(second * width),
                       radius * radius, width, radius * radius},
                      {}, 2) >= 11 * Hierarchy::kUnitsOfScore);
      }
}

TEST_CASE("hierarchy: scores, as the definition has them", "[hierarchy]") {
  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto top = [&] { return int32_t(1 + logarithmic(rng, 30.9)); };
    const auto [topA, topB] = std::minmax({top(), top()});
    Case c{logarithmic(rng, 42.9),     topA,
           logarithmic(rng, 42.9),     topB,
           logarithmic(rng, 30.9) - 1, std::max(1, int32_t(topA * rng.unit()))};
    VoxelWeights weights;
    if (i % 2) weights = {rng.between(1, 30), rng.between(1, 30), rng.between(1, 30)};
    CAPTURE(c.voxelsA, c.topA, c.voxelsB, c.topB, c.faces, c.height, weights.toString());
    const int32_t whole = score(c, weights);
    REQUIRE(whole == slowScore(c, weights));
    // What is left without b's volume term does not grow with b.
    Case larger = c;
    larger.voxelsB += logarithmic(rng, 42.9);
    larger.voxelsB = std::min(larger.voxelsB, JoinScore::kMaxVoxels);
    REQUIRE(score(larger, weights) - 2 * detail::lg(larger.voxelsB) <=
            whole - 2 * detail::lg(c.voxelsB));
    // A common factor of the weights changes nothing.
    if (topB < (1 << 30) / 5) {
      for (int32_t* length : {&c.topA, &c.topB, &c.height}) *length *= 5;
      REQUIRE(score(c, {5 * weights.x, 5 * weights.y, 5 * weights.z}) == whole);
    }
  }
}

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

TEST_CASE("hierarchy: how long grains stay, by hand", "[hierarchy]") {
  // A and B, halves of a grain; a crumb C of it, of 1 %; D, which joins late; E, which touches
  // none.
  Hierarchy hierarchy;
  hierarchy.lowest = -kMaxStrictness;
  hierarchy.classOfNode = {0, 1, 2, 3, 4};
  hierarchy.classes = {
      {0, 90, 500, 0}, {1, 80, 500, 0}, {2, 9, 10, 0}, {3, 70, 400, 0}, {4, 60, 7, 0}};
  const auto units = [](double score) { return int32_t(score * Hierarchy::kUnitsOfScore); };
  hierarchy.joins = {{0, 1, units(14)}, {0, 2, units(9)}, {0, 3, units(6)}};
  using Number = std::optional<double>;
  const auto requireLife = [](const GrainLife& life, Number born, Number dies, Number stability) {
    CHECK(life.born == born);
    CHECK(life.dies == dies);
    CHECK(life.stability == stability);
  };
  const GrainLives at11(hierarchy, 11);
  requireLife(at11.of(0), 14.0, 6.0, 3.0);  // the crumb changes it by less than 2 %
  requireLife(at11.of(1), 14.0, 6.0, 3.0);
  requireLife(at11.of(2), {}, 9.0, 2.0);
  requireLife(at11.of(3), {}, 6.0, 5.0);
  requireLife(at11.of(4), {}, {}, {});
  CHECK(at11.joinedAt(0, 2) == 9.0);
  CHECK(at11.joinedAt(2, 1) == 9.0);
  CHECK(at11.joinedAt(2, 3) == 6.0);
  CHECK_FALSE(at11.joinedAt(3, 4));
  CHECK_FALSE(at11.joinedAt(0, 1));
  const GrainLives at20(hierarchy, 20);
  requireLife(at20.of(0), {}, 14.0, 6.0);
  CHECK(at20.joinedAt(0, 1) == 14.0);
  const GrainLives at8(hierarchy, 8);  // of the three, of which it is almost the same
  requireLife(at8.of(2), 14.0, 6.0, 2.0);
  requireLife(GrainLives(hierarchy, 5).of(3), 6.0, {}, 1.0);
  CHECK_THROWS_AS(GrainLives(hierarchy, 200001), InvalidInput);
}

TEST_CASE("hierarchy: how long grains stay, cut by cut", "[hierarchy]") {
  size_t dead = 0, born = 0, survivors = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    ManifoldGraph graph = randomGraph(rng);
    for (ManifoldGraph::Node& node : graph.nodes)  // so that 2 % are more than a voxel
      if (node.voxels > 0 && rng.chance(0.5)) node.voxels *= 200;
    const Hierarchy hierarchy = mergeHierarchy(graph);
    std::set<double, std::greater<double>> cuts;  // where grains change, descending
    for (const JoinedGrains& join : joinedGrains(hierarchy)) cuts.insert(join.strictness);
    if (cuts.empty()) continue;
    const double at = *std::next(cuts.begin(), rng.below(int(cuts.size()))) + rng.below(2) * 0.001;
    const Merging now = cut(hierarchy, at);
    const std::vector<int64_t> voxels = grainVoxels(graph, now);
    const GrainLives lives(hierarchy, at);
    const int grains = int(voxels.size());
    const auto remains = [&](const Merging& then, int grain) {
      const std::vector<int64_t> others = grainVoxels(graph, then);
      std::map<int32_t, int64_t> common;
      for (size_t i = 0; i < graph.nodes.size(); ++i)
        if (now.grainOfNode[i] == grain && then.grainOfNode[i] > 0)
          common[then.grainOfNode[i]] += graph.nodes[i].voxels;
      return std::any_of(common.begin(), common.end(), [&](const auto& part) {
        return 50 * part.second >= 49 * std::max(voxels[grain - 1], others[part.first - 1]);
      });
    };
    for (int grain = 1; grain <= grains; ++grain) {
      std::optional<double> first, end;
      bool always = remains(cut(hierarchy, kMaxStrictness), grain);
      for (const double k : cuts) {
        const bool there = remains(cut(hierarchy, k), grain);
        if (k >= at && there && !first && !always) first = k;
        if (k < at && !there && !end) end = k;
        if (k < at && there && grains > int(cut(hierarchy, k).representative.size())) ++survivors;
      }
      const GrainLife life = lives.of(now.representative[grain - 1]);
      REQUIRE(life.born == first);
      REQUIRE(life.dies == end);
      born += first.has_value();
      dead += end.has_value();
      for (int other = 1; other < grain; ++other) {
        const uint32_t a = now.representative[grain - 1], b = now.representative[other - 1];
        std::optional<double> joined;
        for (const double k : cuts) {
          const Merging then = cut(hierarchy, k);
          if (k < at && then.grainOfNode[a] == then.grainOfNode[b] && !joined) joined = k;
        }
        REQUIRE(lives.joinedAt(a, b) == joined);
      }
    }
  }
  CHECK(born > 50);
  CHECK(dead > 500);
  CHECK(survivors > 50);
}

TEST_CASE("hierarchy: where grains are most stable", "[hierarchy]") {
  Hierarchy hierarchy;
  hierarchy.lowest = -kMaxStrictness;
  for (uint32_t c = 0; c < 6; ++c) {
    hierarchy.classOfNode.push_back(c);
    hierarchy.classes.push_back({c, 90 - int32_t(c), 1000, 0});
  }
  const auto join = [&](uint32_t second, double score) {
    const auto units = int32_t(std::lround(score * Hierarchy::kUnitsOfScore));
    hierarchy.joins.push_back({0, second, units});
  };
  join(1, 13.7);
  join(2, 11.6);
  join(3, 9.9);
  join(4, 8.4);
  const StableStrictness stable = stableStrictness(hierarchy);
  CHECK(stable.strictness == 12.6);  // between 13.7 and 11.6, 1 from either; so is 12.7
  CHECK(stable.plateau == std::pair(11.7, 13.7));
  REQUIRE(stable.levels.size() == 61);
  CHECK(stable.levels.front().strictness == 8);
  CHECK(stable.levels.front().grains == 2);
  CHECK(stable.levels.back().strictness == 14);
  CHECK(stable.levels.back().grains == 6);
  CHECK(stable.levels[46].stability == 1);
  // At 14 two of six grains are 0.3 from their join, another four stay.
  CHECK(stable.levels.back().stability == Approx((2 * 0.3 + 4) / 6).margin(0.001));

  hierarchy.joins.clear();
  CHECK(stableStrictness(hierarchy).strictness == 11);  // as stable anywhere
  CHECK(stableStrictness(hierarchy).plateau == std::pair(8.0, 14.0));
  hierarchy.classOfNode.push_back(6);
  hierarchy.classes.push_back({6, 50, 1000, 0});
  double score = 13.2;
  for (uint32_t c = 1; c < 7; ++c, score -= 0.9) join(c, score);
  CHECK_FALSE(stableStrictness(hierarchy).plateau);
  CHECK(stableStrictness({}).strictness == 11);
  hierarchy.lowest = 9;
  CHECK_THROWS_AS(stableStrictness(hierarchy), InvalidInput);
}
