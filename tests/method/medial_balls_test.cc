// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/medial_balls.h"

#include <map>
#include <string>
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

struct Ball {
  int64_t squaredRadius = 0, cellSize = 0;
};
using Balls = std::map<Coord, Ball>;

bool operator==(const Ball& a, const Ball& b) {
  return a.squaredRadius == b.squaredRadius && a.cellSize == b.cellSize;
}

/// What the stage finds in a map, as one list.
Balls found(const LeafIndex& index, const PowerMap& map) {
  const VoxelSet set = medialBalls(index, map);
  const MedialBallTable table = measureBalls(index, map, set);
  const std::vector<VoxelId> members = set.members();
  REQUIRE(set.size() == members.size());  // ranked
  REQUIRE(table.cellSize.size() == members.size());
  REQUIRE(table.squaredRadius.size() == members.size());
  Balls balls;
  for (size_t i = 0; i < members.size(); ++i)
    balls[index.coord(members[i])] = {table.squaredRadius[i], table.cellSize[i]};
  return balls;
}

/// The oracle's power map, and the balls that it found in it.
void requireOracleBalls(const ObjectVolume& object, Tiles tiles) {
  const LeafIndex index(*toMask(object, tiles));
  const auto distance = oracleDistance(object, false, {});
  const OraclePower power = oraclePower(object, distance, object);
  Balls expected;
  int64_t voxels = 0;
  for (const MedialBall& ball : oracleBalls(power, distance)) {
    expected[ball.center] = {ball.squaredRadius, ball.cellSize};
    voxels += ball.cellSize;
  }
  REQUIRE(found(index, toPowerMap(index, power)) == expected);
  REQUIRE(voxels == index.voxelCount());  // the cells make up the object
}

/// Any sites, not those of a power map: runs of random length, radii that tell balls apart.
struct AnySites {
  ObjectVolume object;
  SiteMap site;
  DenseVolume<int64_t> squaredRadius;
  Balls expected;

  AnySites(const CoordBBox& box, int balls, uint64_t seed) : site(box), squaredRadius(box) {
    Rng rng(seed);
    object = randomVolume(VolumeKind::denseNoise, box, rng);
    std::vector<int> voxels;
    for (int i = 0; i < object.size(); ++i) {
      squaredRadius[i] = 1 + rng.below(1000);
      if (object[i]) voxels.push_back(i);
    }
    int last = -1;
    for (const int i : voxels) {
      if (last < 0 || rng.chance(0.2))
        last = voxels[size_t(rng.below(balls) * 7919) % voxels.size()];
      site[i] = last;
      Ball& ball = expected[object.coord(last)];
      ball.squaredRadius = squaredRadius[last];
      ++ball.cellSize;
    }
  }

  PowerMap map(const LeafIndex& index) const {
    OraclePower power{site, DenseVolume<int64_t>(object.box())};
    for (int i = 0; i < object.size(); ++i) {
      const Coord d = object.coord(i) - object.coord(site[i]);
      power.power[i] = d.x() * d.x() + d.y() * d.y() + d.z() * d.z() - squaredRadius[site[i]];
    }
    return toPowerMap(index, power);
  }
};

}  // namespace

TEST_CASE("medial_balls: a row, drawn by hand", "[medial_balls]") {
  // Ten voxels in two leaves. Sites: 2 of 0..3, 9 of 4, 2 of 5, 9 of 6..9; D = 5 and 30.
  const ObjectVolume object = fromPicture("##########");
  const LeafIndex index(*toMask(object));
  PowerMap map{VoxelArray<int32_t>(10), VoxelArray<VoxelId>(10)};
  for (int z = 0; z < 10; ++z) {
    const bool first = z < 4 || z == 5;
    map.site[size_t(z)] = idOf(index, Coord(0, 0, first ? 2 : 9));
    map.power[size_t(z)] = first ? (z - 2) * (z - 2) - 5 : (z - 9) * (z - 9) - 30;
  }
  const VoxelSet balls = medialBalls(index, map);
  CHECK(balls.members() == std::vector<VoxelId>{2, 512 + 1});
  const MedialBallTable table = measureBalls(index, map, balls);
  CHECK(table.cellSize == std::vector<uint32_t>{5, 5});
  CHECK(table.squaredRadius == std::vector<int32_t>{5, 30});
  // A set may hold more than the sites: cells without a voxel.
  const VoxelSet more = toVoxelSet(index, {{0, 0, 2}, {0, 0, 3}, {0, 0, 9}});
  CHECK(measureBalls(index, map, more).cellSize == std::vector<uint32_t>{5, 0, 5});
}

TEST_CASE("medial_balls: a rod of three equal balls, drawn by hand", "[medial_balls]") {
  // 3 x 3 x 5 voxels: D = 4 at z = 1, 2, 3 of the middle line; each of them keeps itself. The
  // planes z = 0 and 1 map to the first, 2 to the second, 3 and 4 to the third.
  const std::string slice = "#####/#####/#####";
  const ObjectVolume object = fromPicture(slice + "|" + slice + "|" + slice);
  const LeafIndex index(*toMask(object));
  CHECK(found(index, powerMap(index, squaredDistance(index, {}))) ==
        Balls{{{1, 1, 1}, {4, 18}}, {{1, 1, 2}, {4, 9}}, {{1, 1, 3}, {4, 18}}});
}

TEST_CASE("medial_balls: of edge cases", "[medial_balls]") {
  for (const EdgeCase& c : edgeCases()) {
    INFO(c.name);
    requireOracleBalls(c.object, c.tiles);
  }
}

TEST_CASE("medial_balls: those that the oracle finds", "[medial_balls]") {
  for (uint64_t seed = 1; seed <= 190; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 13), rng.between(1, 13), rng.between(1, 13));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    INFO("seed " << seed << ", " << name(kind) << '\n' << picture(object));
    requireOracleBalls(object, seed % 2 ? Tiles::wherePossible : Tiles::none);
  }
}

TEST_CASE("medial_balls: of any map", "[medial_balls]") {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const Coord size(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20));
    const AnySites any(boxAt(randomOrigin(rng), size), rng.between(1, 60), seed);
    const LeafIndex index(*toMask(any.object));
    REQUIRE(found(index, any.map(index)) == any.expected);
  }
}

TEST_CASE("medial_balls: move with the object", "[medial_balls]") {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const ObjectVolume object =
        randomVolume(VolumeKind::roughBalls, boxAt({-6, 1, 40}, {17, 22, 27}), rng);
    const auto at = [&](const Coord& shift) {
      const LeafIndex index(*toMask(translated(object, shift)));
      Balls back;
      for (const auto& [p, ball] : found(index, powerMap(index, squaredDistance(index, {}))))
        back[p - shift] = ball;
      return back;
    };
    const Balls expected = at(Coord(0));
    for (int step = 1; step <= 8; ++step) REQUIRE(at(Coord(step, -step, 3 * step)) == expected);
  }
}

TEST_CASE("medial_balls: threads do not matter", "[medial_balls]") {
  // More leaves than one task takes; cells that lie in many of them, and cells of one run.
  for (const int balls : {3, 30000}) {
    const AnySites any(boxAt({-1, -150, 3}, {2, 300, 310}), balls, 3);
    const LeafIndex index(*toMask(any.object));
    REQUIRE(index.leafCount() > 2048);
    const PowerMap map = any.map(index);
    for (const int threads : {1, 2, 2, 4, 4, 4}) {
      CAPTURE(balls, threads);
      CHECK((withThreads(threads, [&] { return found(index, map); }) == any.expected));
    }
  }
}

TEST_CASE("medial_balls: none once interrupted", "[medial_balls]") {
  const LeafIndex index(*toMask(fromPicture("##")));
  const PowerMap map = powerMap(index, squaredDistance(index, {}));
  const VoxelSet balls = medialBalls(index, map);
  StopAtOnce stop;
  CHECK_THROWS_AS(medialBalls(index, map, &stop), Interrupted);
  CHECK_THROWS_AS(measureBalls(index, map, balls, &stop), Interrupted);
}
