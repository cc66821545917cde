// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/last_join.h"

#include <vector>

#include "support/catch.h"

using namespace vdb_madf;

TEST_CASE("grain_parts: the last join, drawn by hand", "[grain_parts]") {
  // Five manifolds; the second and the fourth are of one class.
  ManifoldGraph graph;
  for (const int top : {9, 16, 25, 4, 36}) graph.nodes.push_back({{0, 0, top}, top, 3});
  Hierarchy hierarchy;
  hierarchy.classOfNode = {0, 1, 2, 1, 3};
  hierarchy.classes = {{0, 9, 3, 0}, {1, 16, 6, 0}, {2, 25, 3, 0}, {4, 36, 3, 0}};
  hierarchy.joins = {{0, 1, 900}, {2, 3, 800}, {1, 3, 700}};
  using Sides = std::vector<char>;
  const auto sides = [&](const std::vector<uint32_t>& nodes, const std::vector<int64_t>& voxels) {
    return detail::beyondLastJoin(graph, hierarchy, nodes, voxels);
  };
  CHECK(sides({0, 1, 2, 3, 4}, {3, 3, 3, 3, 3}) == Sides{1, 1, 0, 1, 0});
  CHECK(sides({0, 1, 3}, {3, 3, 3}) == Sides{1, 0, 0});
  CHECK(sides({2, 4}, {3, 3}) == Sides{1, 0});
  // What has no voxels makes no side.
  CHECK(sides({0, 1, 2, 3, 4}, {3, 3, 0, 0, 0}) == Sides{0, 1, 0, 1, 0});
  CHECK(sides({0, 2, 4}, {0, 3, 3}) == Sides{0, 1, 0});
  CHECK_FALSE(sides({1, 3}, {3, 3}));
  CHECK_FALSE(sides({0}, {3}));
  CHECK_FALSE(sides({}, {}));
  hierarchy.joins.pop_back();
  CHECK_FALSE(sides({0, 1, 2, 3, 4}, {3, 3, 3, 3, 3}));
  CHECK(sides({0, 1}, {3, 3}) == Sides{1, 0});
}
