// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/gamma_filter.h"

#include <ctime>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "support/stage_input.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using Values = std::vector<int64_t>;

/// What the filter takes, from the stages before it, and the filtered map as dense volumes.
struct Filter {
  LeafIndex index;
  DenseVolume<int64_t> distance;
  VoxelSet balls, kept;
  MedialBallTable table;
  DenseVolume<int64_t> power;
  DenseVolume<int64_t> site;  // an id

  Filter(const ObjectVolume& object, int64_t gamma, Tiles tiles = Tiles::none)
      : index(*toMask(object, tiles)) {
    distance = dense(index, squaredDistance(index, {}).values, object.box());
    PowerMap map = powerMap(index, squaredDistance(index, {}));
    balls = medialBalls(index, map);
    table = measureBalls(index, map, balls);
    kept = keptBalls(index, map, balls, table, gamma);
    map = filteredPowerMap(index, std::move(map), balls, table, kept);
    power = dense(index, map.power, object.box());
    site = dense(index, map.site, object.box());
  }
  Coord siteOf(const Coord& p) const { return index.coord(VoxelId(site[p])); }
};

ObjectVolume rod() {
  const std::string slice = "#####/#####/#####";
  return fromPicture(slice + "|" + slice + "|" + slice);
}

int64_t squaredLength(const Coord& d) {
  return int64_t(d.x()) * d.x() + int64_t(d.y()) * d.y() + int64_t(d.z()) * d.z();
}

void requireOracleFilter(const ObjectVolume& object, int64_t gamma, Tiles tiles) {
  const Filter filter(object, gamma, tiles);
  const OraclePower unfiltered = oraclePower(object, filter.distance, object);
  const ObjectVolume kept =
      oracleKeptBalls(object, unfiltered, oracleBalls(unfiltered, filter.distance), gamma);
  std::vector<Coord> expected;
  for (int i = 0; i < kept.size(); ++i)
    if (kept[i]) expected.push_back(kept.coord(i));
  REQUIRE(coordsOf(filter.index, filter.kept) == expected);
  REQUIRE(filter.kept.size() == expected.size());
  const OraclePower filtered = oracleFilteredPower(object, filter.distance, kept);
  for (int i = 0; i < object.size(); ++i) {
    if (!object[i]) continue;
    const Coord p = object.coord(i);
    CAPTURE(toString(p));
    REQUIRE(filter.power[p] == filtered.power[i]);
    REQUIRE(filter.siteOf(p) == object.coord(filtered.site[i]));
  }
}

}  // namespace

TEST_CASE("gamma_filter: a rod of three equal balls, drawn by hand", "[gamma_filter]") {
  // D = 4 at z = 1, 2, 3 of the middle line; cells of 18, 9 and 18 voxels.
  for (const int64_t gamma : {0, 1, 9}) {
    const Filter filter(rod(), gamma);
    CHECK(coordsOf(filter.index, filter.kept) ==
          std::vector<Coord>{{1, 1, 1}, {1, 1, 2}, {1, 1, 3}});
    CHECK(rowOf(filter.power, 1, 1) == Values{-3, -4, -4, -4, -3});
  }
  // The plane z = 2 has 1 - 4 + (0, 1 or 2) to both of the others: the smaller coordinate.
  for (const int64_t gamma : {10, 18}) {
    const Filter filter(rod(), gamma);
    CHECK(coordsOf(filter.index, filter.kept) == std::vector<Coord>{{1, 1, 1}, {1, 1, 3}});
    CHECK(rowOf(filter.power, 1, 1) == Values{-3, -4, -3, -4, -3});
    CHECK(rowOf(filter.power, 0, 0) == Values{-1, -2, -1, -2, -1});
    CHECK(filter.siteOf(Coord(0, 2, 2)) == Coord(1, 1, 1));
    CHECK(filter.siteOf(Coord(0, 2, 3)) == Coord(1, 1, 3));
  }
  // None is large enough: the best one stays; z = 3 and 4 are completed, 4 - 4 and 9 - 4.
  for (const int64_t gamma : {int64_t(19), std::numeric_limits<int64_t>::max()}) {
    const Filter filter(rod(), gamma);
    CHECK(coordsOf(filter.index, filter.kept) == std::vector<Coord>{{1, 1, 1}});
    CHECK(rowOf(filter.power, 1, 1) == Values{-3, -4, -3, 0, 5});
    CHECK(filter.siteOf(Coord(2, 2, 4)) == Coord(1, 1, 1));
  }
}

TEST_CASE("gamma_filter: the completion stays within the object", "[gamma_filter]") {
  // Blocks around (1, 1, 1) and (1, 5, 8), in the plane x = 1 a path of single voxels from the
  // first along y = 1 to z = 11, down to y = 5 and back to the second. On y = 1 the powers are
  // (z - 1)^2 - 4 and (z - 8)^2 + 16 - 4: the second's from z = 6 on, though it comes later there.
  ObjectVolume object(boxAt({0, 0, 0}, {3, 7, 12}));
  addBlock(object, {1, 1, 1});
  addBlock(object, {1, 5, 8});
  for (int z = 3; z <= 11; ++z) object[Coord(1, 1, z)] = 1;
  for (int y = 2; y <= 5; ++y) object[Coord(1, y, 11)] = 1;
  object[Coord(1, 5, 10)] = 1;
  const Filter whole(object, 2);
  CHECK(rowOf(whole.power, 1, 1) == Values{-3, -4, -3, 0, 5, 12, 16, 13, 12, 13, 16, 21});
  CHECK(whole.siteOf(Coord(1, 1, 5)) == Coord(1, 1, 1));
  CHECK(whole.siteOf(Coord(1, 1, 6)) == Coord(1, 5, 8));
  // Cut off, the second ball is as near as before, but beyond a pore.
  object[Coord(1, 3, 11)] = 0;
  const Filter cut(object, 2);
  CHECK(rowOf(cut.power, 1, 1) == Values{-3, -4, -3, 0, 5, 12, 21, 32, 45, 60, 77, 96});
  CHECK(cut.siteOf(Coord(1, 2, 11)) == Coord(1, 1, 1));
  CHECK(cut.siteOf(Coord(1, 4, 11)) == Coord(1, 5, 8));
}

TEST_CASE("gamma_filter: a small loose piece keeps its best ball", "[gamma_filter]") {
  // Two voxels of equal balls beside a block: the smaller coordinate.
  ObjectVolume object(boxAt({0, 0, 0}, {3, 3, 7}));
  addBlock(object, {1, 1, 1});
  object[Coord(1, 1, 5)] = object[Coord(1, 1, 6)] = 1;
  const Filter filter(object, 20);
  CHECK(coordsOf(filter.index, filter.kept) == std::vector<Coord>{{1, 1, 1}, {1, 1, 5}});
  CHECK(filter.siteOf(Coord(1, 1, 6)) == Coord(1, 1, 5));
  CHECK(filter.power[Coord(1, 1, 6)] == 0);
}

TEST_CASE("gamma_filter: of edge cases", "[gamma_filter]") {
  for (const EdgeCase& c : edgeCases())
    for (const int64_t gamma : {0, 2, 30, 100000}) {
      INFO(c.name << ", gamma " << gamma);
      requireOracleFilter(c.object, gamma, c.tiles);
    }
}

TEST_CASE("gamma_filter: agrees with the oracle", "[gamma_filter]") {
  for (uint64_t seed = 1; seed <= 380; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 14), rng.between(1, 14), rng.between(1, 14));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    const int64_t gamma = std::vector<int64_t>{0, 1, 2, 3, 5, 9, 20, 60, 1000}[rng.next() % 9];
    INFO("seed " << seed << ", " << name(kind) << ", gamma " << gamma << '\n' << picture(object));
    requireOracleFilter(object, gamma, seed % 2 ? Tiles::wherePossible : Tiles::none);
  }
}

TEST_CASE("gamma_filter: what holds for every filtered map", "[gamma_filter]") {
  Rng rng(21);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-20, 3, -45}, {50, 44, 61}), rng);
  const DenseVolume<int> component = sixComponents(object);
  for (const int64_t gamma : {4, 50, 2000}) {
    CAPTURE(gamma);
    const Filter filter(object, gamma);
    std::set<int> served;
    for (const VoxelId ball : filter.kept.members()) {
      REQUIRE(filter.balls.contains(ball));
      served.insert(component[filter.index.coord(ball)]);
    }
    int uncovered = 0;
    for (int i = 0; i < object.size(); ++i) {
      if (!object[i]) continue;
      const Coord p = object.coord(i), site = filter.siteOf(p);
      const auto powerOf = [&](const Coord& x) {
        return squaredLength(p - x) - filter.distance[x];
      };
      REQUIRE(served.count(component[i]) == 1);
      REQUIRE(filter.kept.contains(VoxelId(filter.site[i])));
      REQUIRE(component[site] == component[i]);
      REQUIRE(filter.power[i] == powerOf(site));
      if (filter.power[i] < 0) continue;
      ++uncovered;
      for (const Coord& step : kSixNeighbors)  // no neighbor has a better one to offer
        if (object.get(p + step, 0)) REQUIRE(powerOf(filter.siteOf(p + step)) >= filter.power[i]);
    }
    CHECK(uncovered > 100);
  }
}

TEST_CASE("gamma_filter: moves with the object, whatever the threads", "[gamma_filter]") {
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-6, 1, 40}, {55, 49, 52}), rng);
  const Filter expected = withThreads(1, [&] { return Filter(object, 40); });
  for (int step = 0; step <= 8; ++step) {
    const Coord shift(step, -step, 3 * step);
    const Filter other =
        withThreads(1 + step % 4, [&] { return Filter(translated(object, shift), 40); });
    CAPTURE(step);
    REQUIRE(other.kept.size() == expected.kept.size());
    for (int i = 0; i < object.size(); ++i) {
      if (!object[i]) continue;
      const Coord p = object.coord(i);
      REQUIRE(other.power[i] == expected.power[i]);
      REQUIRE(other.siteOf(p + shift) == expected.siteOf(p) + shift);
    }
  }
}

TEST_CASE("gamma_filter: a thin path is completed in time that goes with its length",
          "[gamma_filter][long]") {
  constexpr int kSide = 500;
  const auto mask = MaskGrid::create();
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (y % 2 == 0 || x == (y % 4 == 1 ? kSide - 1 : 0)) mask->tree().setValueOn(Coord(x, y, 0));
  const LeafIndex index(*mask);
  PowerMap map = powerMap(index, squaredDistance(index, {}));
  const VoxelSet balls = medialBalls(index, map);
  const MedialBallTable table = measureBalls(index, map, balls);
  const VoxelSet kept = keptBalls(index, map, balls, table, 2);
  const std::clock_t start = std::clock();
  map = filteredPowerMap(index, std::move(map), balls, table, kept);
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  CHECK(kept.size() == 1);
  INFO(seconds << " s of computing");
  CHECK(seconds < 4e-6 * double(index.voxelCount()));
}

TEST_CASE("gamma_filter: none once interrupted", "[gamma_filter]") {
  const LeafIndex index(*toMask(rod()));
  PowerMap map = powerMap(index, squaredDistance(index, {}));
  const VoxelSet balls = medialBalls(index, map);
  const MedialBallTable table = measureBalls(index, map, balls);
  StopAtOnce stop;
  CHECK_THROWS_AS(keptBalls(index, map, balls, table, 10, &stop), Interrupted);
  CHECK_THROWS_AS(filteredPowerMap(index, std::move(map), balls, table, balls, &stop), Interrupted);
}
