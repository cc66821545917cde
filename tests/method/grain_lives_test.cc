// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/grain_lives.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "support/catch.h"
#include "support/random_graph.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

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
