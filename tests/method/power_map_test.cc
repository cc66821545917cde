// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/power_map.h"

#include <algorithm>
#include <limits>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/oracle.h"
#include "support/random_case.h"
#include "vdb_madf/method/detail/power_passes.h"
#include "vdb_madf/method/kernels/power_windows.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// Voxels where the map is not the oracle's: power and, where it is negative, site.
int powerDifferences(const LeafIndex& index, const PowerMap& map, const ObjectVolume& object,
                     const OraclePower& expected) {
  int count = 0;
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    const Coord p = object.coord(i);
    const size_t rank = index.rank(idOf(index, p));
    if (expected.site[i] == kNoSite)
      count += map.power[rank] != kUncovered;
    else
      count += map.power[rank] != expected.power[i] ||
               index.coord(map.site[rank]) != object.coord(expected.site[i]);
  }
  return count;
}

// Bounds on D for which rows take lower envelopes, with keys of 64 and of 128 bits.
constexpr int32_t kLargeBound = detail::kLargestKeyedSquaredRadius + 1;
constexpr int32_t kHugeBound = std::numeric_limits<int32_t>::max();

}  // namespace

TEST_CASE("power_map: agrees with the oracle, by windows and by envelopes", "[power_map]") {
  int voxels = 0;
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(seed + 20000);
    const RandomCase c =
        randomCase(seed, Coord(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20)));
    INFO(describe(c));
    const LeafIndex index(*toMask(c.object, c.tiles));
    const VoxelWeights weights = c.options.weights.value_or(VoxelWeights{});
    const auto distance = oracleDistance(c.object, false, {}, weights);
    const OraclePower expected = oraclePower(c.object, distance, c.object, weights);
    int32_t largest = 0;
    for (int i = 0; i < c.object.size(); ++i)
      if (c.object[i]) largest = std::max(largest, int32_t(distance[i]));
    for (const int32_t bound : {largest, std::max(largest, kLargeBound), kHugeBound}) {
      const PowerMap map = powerMap(index, {byRank<int32_t>(index, distance), bound, weights});
      REQUIRE(powerDifferences(index, map, c.object, expected) == 0);
    }
    voxels += countObject(c.object);
  }
  CHECK(voxels > 10000);
}

TEST_CASE("power_map: of some balls only, by windows and by envelopes", "[power_map]") {
  for (uint64_t seed = 1; seed <= 150; ++seed) {
    Rng rng(seed + 30000);
    const RandomCase c =
        randomCase(seed, Coord(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20)));
    INFO(describe(c));
    const LeafIndex index(*toMask(c.object, c.tiles));
    const VoxelWeights weights = c.options.weights.value_or(VoxelWeights{});
    const auto distance = oracleDistance(c.object, false, {}, weights);
    ObjectVolume sites = c.object;
    const double kept = rng.chance(0.5) ? 0.05 : 0.5;
    DenseVolume<int64_t> start(c.object.box());
    int32_t largest = 0;
    for (int i = 0; i < sites.size(); ++i) {
      sites[i] = c.object[i] && rng.chance(kept);
      start[i] = sites[i] ? -distance[i] : kUncovered;
      if (sites[i]) largest = std::max(largest, int32_t(distance[i]));
    }
    const OraclePower expected = oraclePower(c.object, distance, sites, weights);
    for (const int32_t bound : {largest, std::max(largest, kLargeBound), kHugeBound}) {
      PowerMap map{byRank<int32_t>(index, start), VoxelArray<VoxelId>(size_t(index.voxelCount())),
                   weights};
      detail::sweepPower(index, bound, map);
      REQUIRE(powerDifferences(index, map, c.object, expected) == 0);
    }
  }
}
