// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/flow.h"

#include <algorithm>
#include <map>
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
using Node = ManifoldGraph::Node;

/// A function X -> X without cycles, and D at its fixed points.
struct Sites {
  ObjectVolume object;
  SiteMap site;
  DenseVolume<int64_t> squaredRadius;
};

/// Any: each voxel goes to one that comes before it in a random order, and is among the first
/// `balls` of that order, or stays.
Sites anySites(const CoordBBox& box, uint64_t seed, int balls) {
  Rng rng(seed);
  Sites s{randomVolume(VolumeKind::denseNoise, box, rng), SiteMap(box, kNoSite),
          DenseVolume<int64_t>(box)};
  std::vector<int> order;
  for (int i = 0; i < s.object.size(); ++i) {
    s.squaredRadius[i] = 1 + rng.below(1000);
    if (s.object[i]) order.push_back(i);
  }
  for (size_t i = 1; i < order.size(); ++i)
    std::swap(order[i], order[size_t(rng.below(int(i) + 1))]);
  const double stays = rng.chance(0.5) ? 0.01 : 0.3;
  for (size_t i = 0; i < order.size(); ++i) {
    const int end = std::min(int(i), balls);
    s.site[order[i]] =
        i == 0 || (int(i) < balls && rng.chance(stays)) ? order[i] : order[size_t(rng.below(end))];
  }
  return s;
}

Flow run(const LeafIndex& index, const Sites& s, const VoxelSet& balls) {
  return flow(index, toPowerMap(index, {s.site, s.squaredRadius}).site,
              byRank<int32_t>(index, [&](const Coord& p) { return -s.squaredRadius[p]; }), balls);
}

/// The voxels that some voxel goes to.
VoxelSet images(const LeafIndex& index, const Sites& s) {
  std::set<int> sites;
  for (int i = 0; i < s.object.size(); ++i)
    if (s.object[i]) sites.insert(s.site[i]);
  std::vector<Coord> coords;
  for (const int site : sites) coords.push_back(s.site.coord(site));
  return toVoxelSet(index, coords);
}

/// Empty if the flow is that of the definition: each voxel followed step by step.
std::string flowDifference(const LeafIndex& index, const Flow& found, const Sites& s) {
  const SiteMap critical = oracleFlow(s.site);
  std::map<int, int64_t> voxels;  // in lexicographic order
  for (int i = 0; i < s.object.size(); ++i)
    if (s.object[i]) ++voxels[critical[i]];
  if (found.criticalPoints.size() != voxels.size()) return "the number of critical points";
  std::map<int, uint32_t> number;
  for (const auto& [c, count] : voxels) {
    const Node expected{s.object.coord(c), int32_t(s.squaredRadius[c]), count};
    if (!(found.criticalPoints[number.size()] == expected))
      return "critical point " + std::to_string(number.size());
    const auto next = uint32_t(number.size() + 1);
    number[c] = next;
  }
  for (int i = 0; i < s.object.size(); ++i) {
    if (!s.object[i]) continue;
    const bool own = s.site[i] == critical[i];
    const uint32_t expected = number[critical[i]] | (own ? Flow::kOwnCell : 0);
    if (found.manifold[index.rank(idOf(index, s.object.coord(i)))] != expected)
      return "manifold at " + toString(s.object.coord(i));
  }
  return found.manifold.size() == size_t(index.voxelCount()) ? "" : "the number of voxels";
}

void requireFlow(const Sites& s, Tiles tiles = Tiles::none) {
  const LeafIndex index(*toMask(s.object, tiles));
  REQUIRE(flowDifference(index, run(index, s, images(index, s)), s) == "");
  // Balls that no voxel goes to make no difference.
  std::vector<Coord> all;
  for (int i = 0; i < s.object.size(); ++i)
    if (s.object[i]) all.push_back(s.object.coord(i));
  REQUIRE(flowDifference(index, run(index, s, toVoxelSet(index, all)), s) == "");
}

/// The oracle's (filtered) power map.
Sites oracleSites(const ObjectVolume& object, int64_t gamma) {
  const auto distance = oracleDistance(object, false, {});
  OraclePower power = oraclePower(object, distance, object);
  if (gamma > 0)
    power = oracleFilteredPower(
        object, distance, oracleKeptBalls(object, power, oracleBalls(power, distance), gamma));
  return {object, power.site, distance};
}

}  // namespace

TEST_CASE("flow: a row, drawn by hand", "[flow]") {
  // 0 -> 1 -> 3 -> 3, 2 -> 3, 4 -> 5 -> 5, 6 -> 4, of D = 10 times the place.
  Sites s{fromPicture("#######"), SiteMap(boxAt(Coord(0), {1, 1, 7})),
          DenseVolume<int64_t>(boxAt(Coord(0), {1, 1, 7}))};
  const std::vector<int> to = {1, 3, 3, 3, 5, 5, 4};
  for (int i = 0; i < 7; ++i) {
    s.site[i] = to[size_t(i)];
    s.squaredRadius[i] = 10 * i;
  }
  const LeafIndex index(*toMask(s.object));
  const Flow found = run(index, s, images(index, s));
  REQUIRE(found.criticalPoints.size() == 2);
  CHECK(found.criticalPoints[0] == Node{{0, 0, 3}, 30, 4});
  CHECK(found.criticalPoints[1] == Node{{0, 0, 5}, 50, 3});
  constexpr uint32_t kOwn = Flow::kOwnCell;
  const std::vector<uint32_t> expected = {1, 1 | kOwn, 1 | kOwn, 1 | kOwn, 2 | kOwn, 2 | kOwn, 2};
  for (size_t i = 0; i < 7; ++i) CHECK(found.manifold[i] == expected[i]);
}

TEST_CASE("flow: critical points in the order of coordinates, not of leaves", "[flow]") {
  // (1, 0, 0) lies in the leaf before that of (0, 0, 9).
  Sites s{ObjectVolume(boxAt(Coord(0), {2, 1, 10})), SiteMap(boxAt(Coord(0), {2, 1, 10}), kNoSite),
          DenseVolume<int64_t>(boxAt(Coord(0), {2, 1, 10}), 1)};
  for (const Coord& p : {Coord(0, 0, 9), Coord(1, 0, 0)}) {
    s.object[p] = 1;
    s.site[p] = s.object.index(p);
  }
  const LeafIndex index(*toMask(s.object));
  const Flow found = run(index, s, images(index, s));
  REQUIRE(found.criticalPoints.size() == 2);
  CHECK(found.criticalPoints[0].position == Coord(0, 0, 9));
  CHECK(found.manifold[0] == (2 | Flow::kOwnCell));
  requireFlow(s);
}

TEST_CASE("flow: of edge cases", "[flow]") {
  for (const EdgeCase& c : edgeCases())
    for (const int64_t gamma : {0, 30}) {
      INFO(c.name << ", gamma " << gamma);
      requireFlow(oracleSites(c.object, gamma), c.tiles);
    }
}

TEST_CASE("flow: of the oracle's power maps", "[flow]") {
  for (uint64_t seed = 1; seed <= 190; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 12), rng.between(1, 12), rng.between(1, 12));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    const int64_t gamma = rng.chance(0.5) ? 0 : rng.between(2, 30);
    INFO("seed " << seed << ", " << name(kind) << ", gamma " << gamma << '\n' << picture(object));
    requireFlow(oracleSites(object, gamma), seed % 2 ? Tiles::wherePossible : Tiles::none);
  }
}

TEST_CASE("flow: of any map without cycles", "[flow]") {
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const Coord size(rng.between(1, 20), rng.between(1, 20), rng.between(1, 20));
    requireFlow(anySites(boxAt(randomOrigin(rng), size), seed, rng.between(1, 500)));
  }
}

TEST_CASE("flow: moves with the object", "[flow]") {
  const Sites s = anySites(boxAt({-6, 1, 40}, {12, 11, 9}), 8, 200);
  for (int step = 1; step <= 8; ++step) {
    CAPTURE(step);
    const ObjectVolume object = translated(s.object, Coord(step, -step, 3 * step));
    Sites moved{object, SiteMap(object.box()), DenseVolume<int64_t>(object.box())};
    for (int i = 0; i < object.size(); ++i) {
      moved.site[i] = s.site[i];
      moved.squaredRadius[i] = s.squaredRadius[i];
    }
    requireFlow(moved);
  }
}

TEST_CASE("flow: threads do not matter", "[flow]") {
  // More leaves and more balls than one task takes.
  const Sites s = anySites(boxAt({-1, -70, 3}, {2, 150, 160}), 2, 30000);
  const LeafIndex index(*toMask(s.object));
  REQUIRE(index.leafCount() > 512);
  const VoxelSet balls = images(index, s);
  REQUIRE(balls.size() > 8192);
  for (const int threads : {1, 2, 4, 4}) {
    CAPTURE(threads);
    const Flow found = withThreads(threads, [&] { return run(index, s, balls); });
    CHECK(flowDifference(index, found, s) == "");
  }
}

TEST_CASE("flow: none once interrupted", "[flow]") {
  const Sites s = anySites(boxAt(Coord(0), Coord(4)), 1, 9);
  const LeafIndex index(*toMask(s.object));
  StopAtOnce stop;
  CHECK_THROWS_AS(flow(index, toPowerMap(index, {s.site, s.squaredRadius}).site,
                       byRank<int32_t>(index, s.squaredRadius), images(index, s), &stop),
                  Interrupted);
}
