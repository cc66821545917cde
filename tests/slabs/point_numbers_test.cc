// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Numbers of points in the order of all of them, which come slab by slab.

#include "vdb_madf/slabs/cuts/point_numbers.h"

#include <algorithm>
#include <set>

#include "support/catch.h"
#include "support/random_volume.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::PointNumbers;

TEST_CASE("point_numbers: numbers are places in the sorted list of all points", "[point_numbers]") {
  for (uint64_t seed = 1; seed <= 500; ++seed) {
    INFO("seed " << seed);
    Rng rng(seed);
    const int slabs = rng.between(1, 5), side = rng.between(1, 6), count = rng.below(40);
    std::set<Coord> all;
    for (int i = 0; i < count; ++i)
      all.insert({rng.below(side) - 2, rng.below(side) - 2, rng.below(8 * slabs)});
    const auto pointsOf = [&](int slab) {
      std::vector<Coord> points;
      for (const Coord& p : all)
        if (p.z() / 8 == slab) points.push_back(p);
      return points;
    };
    PointNumbers numbers;
    for (int s = 0; s < slabs; ++s) numbers.count(pointsOf(s));
    numbers.finish();
    for (int s = 0; s < slabs; ++s) {
      std::vector<uint32_t> expected;
      for (const Coord& p : pointsOf(s))
        expected.push_back(uint32_t(std::distance(all.begin(), all.find(p))) + 1);
      REQUIRE(numbers.next(pointsOf(s)) == expected);
    }
  }
}
