// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/weakest_neck.h"

#include <vector>

#include "support/catch.h"
#include "support/naive_neck.h"
#include "support/random_volume.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("grain_parts: the weakest neck, drawn by hand", "[grain_parts]") {
  // Two large balls, a bump on the first that hardly sticks out, and one without voxels.
  ManifoldGraph graph;
  graph.nodes = {
      {{0, 0, 0}, 400, 9}, {{0, 0, 9}, 9, 2}, {{0, 0, 30}, 441, 9}, {{0, 0, 60}, 900, 0}};
  graph.edges = {{0, 1, 1, 8, true}, {0, 2, 1, 385, true}, {1, 3, 1, 2, true}};
  using Sides = std::vector<char>;
  CHECK(detail::beyondWeakestNeck(graph, {0, 1, 2}, {9, 2, 9}) == Sides{1, 1, 0});
  CHECK(detail::beyondWeakestNeck(graph, {0, 1}, {9, 2}) == Sides{0, 1});
  CHECK(detail::beyondWeakestNeck(graph, {0, 1, 2, 3}, {9, 2, 9, 0}) == Sides{0, 0, 1, 0});
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {1, 3}, {2, 0}));
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {2}, {9}));
  CHECK_FALSE(detail::beyondWeakestNeck(graph, {}, {}));
  // Without an edge.
  CHECK(detail::beyondWeakestNeck(graph, {1, 2}, {2, 9}) == Sides{1, 0});
}

TEST_CASE("grain_parts: the weakest neck of random graphs", "[grain_parts]") {
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    ManifoldGraph graph;
    const int count = rng.between(1, 9);
    for (int i = 0; i < count; ++i) graph.nodes.push_back({Coord(i, 0, 0), rng.between(1, 12), 0});
    for (uint32_t i = 0; i < uint32_t(count); ++i)
      for (uint32_t j = i + 1; j < uint32_t(count); ++j)
        if (j == i + 1 || rng.chance(0.3))
          graph.edges.push_back({i, j, 1, rng.between(-2, 9), false});
    std::vector<uint32_t> nodes;
    std::vector<int64_t> voxels;
    const int first = rng.below(count);
    for (int i = first; i < count; ++i) {
      nodes.push_back(uint32_t(i));
      voxels.push_back(rng.chance(0.3) ? 0 : rng.between(1, 5));
    }
    REQUIRE(detail::beyondWeakestNeck(graph, nodes, voxels) == naiveNeck(graph, nodes, voxels));
  }
}
