// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/join_small.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_volume.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Numbers = std::vector<uint32_t>;

}  // namespace

TEST_CASE("join_small: a crumb goes to the neighbor of most faces", "[join_small]") {
  const std::vector<GrainContact> row{{0, 1, 4}, {1, 2, 5}, {2, 3, 5}};
  SECTION("most faces, then the smaller number") {
    CHECK(joinSmall({50, 3, 60, 3}, row, 4) == Numbers{0, 2, 2, 2});
    CHECK(joinSmall({50, 60, 3, 70}, row, 4) == Numbers{0, 1, 1, 3});
    CHECK(joinSmall({50, 3, 60, 3}, row, 3) == Numbers{0, 1, 2, 3});
    CHECK(joinSmall({50, 3, 60, 3}, row, 0) == Numbers{0, 1, 2, 3});
  }
  SECTION("the contacts of one pair are added") {
    CHECK(joinSmall({50, 3, 60}, {{0, 1, 4}, {1, 2, 5}, {1, 0, 2}}, 4) == Numbers{0, 0, 2});
  }
  SECTION("what is isolated stays") {
    CHECK(joinSmall({1, 2, 60}, {{1, 2, 1}}, 9) == Numbers{0, 2, 2});
    CHECK(joinSmall({}, {}, 9).empty());
  }
  SECTION("the smallest goes first, and may make its neighbor large enough") {
    // 2 would have joined 3, had it been first.
    CHECK(joinSmall({4, 50, 6, 60}, {{0, 2, 1}, {0, 1, 1}, {2, 3, 9}}, 7) == Numbers{1, 1, 3, 3});
    CHECK(joinSmall({4, 50, 6, 60}, {{0, 2, 2}, {0, 1, 1}, {2, 3, 9}}, 7) == Numbers{2, 1, 2, 3});
    CHECK(joinSmall({4, 50, 6, 60}, {{0, 2, 2}, {0, 1, 1}, {2, 3, 9}}, 11) == Numbers{3, 1, 3, 3});
  }
  SECTION("contacts of a part count for the whole") {
    // 1 and 0 become one of 5 faces with 3, more than the 4 with 2.
    CHECK(joinSmall({1, 2, 60, 70}, {{0, 1, 9}, {0, 3, 3}, {1, 3, 2}, {1, 2, 4}}, 10) ==
          Numbers{3, 3, 2, 3});
    // 0 touches 2 with 3 + 3 faces once 1 is part of 2.
    CHECK(joinSmall({2, 1, 60, 70}, {{0, 1, 3}, {1, 2, 4}, {0, 2, 3}, {0, 3, 5}}, 10) ==
          Numbers{2, 2, 2, 3});
  }
}

TEST_CASE("join_small: manifolds in no grain join none", "[join_small]") {
  ManifoldGraph graph;
  for (const int64_t voxels : {3, 0, 40, 5})
    graph.nodes.push_back({{0, 0, 9 * int(graph.nodes.size())}, 4, voxels, 2});
  graph.nodes[2].squaredRadius = 9;
  graph.edges = {{0, 1, 7, 1, true}, {0, 2, 1, 1, true}, {1, 3, 7, 1, true}};
  const Merging apart = mergeClasses(graph, {0, 1, 2, 3});
  REQUIRE(apart.grainOfNode == std::vector<int32_t>{1, 0, 2, 3});
  const Merging joined = joinSmallGrains(graph, apart, 10);
  CHECK(joined.grainOfNode == std::vector<int32_t>{1, 0, 1, 2});
  CHECK(joined.representative == Numbers{2, 3});
}

TEST_CASE("join_small: as the oracle does, on random graphs", "[join_small]") {
  for (uint64_t seed = 1; seed <= 2000; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const int count = rng.between(1, 20), sizes = rng.between(1, 40), most = rng.between(1, 9);
    const double empty = rng.chance(0.3) ? 0.2 : 0, density = rng.unit() * rng.unit();
    ManifoldGraph graph;
    for (int i = 0; i < count; ++i)
      graph.nodes.push_back(
          {{0, 0, 9 * i}, rng.between(1, 5), rng.chance(empty) ? 0 : rng.between(1, sizes), 1});
    for (uint32_t a = 0; a < graph.nodes.size(); ++a)
      for (uint32_t b = a + 1; b < graph.nodes.size(); ++b)
        if (rng.chance(density)) graph.edges.push_back({a, b, rng.between(1, most), 0, false});
    std::vector<uint32_t> classes;
    for (int i = 0; i < count; ++i)
      classes.push_back(uint32_t(rng.chance(0.6) ? i : rng.below(count)));
    const int64_t least = rng.between(0, 2 * sizes);
    const Merging apart = mergeClasses(graph, classes);
    const Merging joined = joinSmallGrains(graph, apart, least);
    const Merging expected = mergeClasses(graph, oracleJoinSmall(graph, apart.grainOfNode, least));
    REQUIRE(joined.grainOfNode == expected.grainOfNode);
    REQUIRE(joined.representative == expected.representative);
  }
}
