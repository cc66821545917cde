// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/stable_strictness.h"

#include <cmath>
#include <utility>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/hierarchy.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

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
