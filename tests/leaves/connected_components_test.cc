// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/connected_components.h"

#include <map>
#include <string>
#include <vector>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/oracle.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::ConnectedComponents;

uint32_t count(const ObjectVolume& object) {
  return ConnectedComponents(LeafIndex(*toMask(object))).count();
}

/// The components are those of a flood fill, numbered 0, 1, ... in some order.
void requireComponents(const ObjectVolume& object, Tiles tiles = Tiles::none) {
  const LeafIndex index(*toMask(object, tiles));
  const ConnectedComponents components(index);
  const DenseVolume<int> expected = sixComponents(object);
  std::map<uint32_t, int> expectedOf;
  std::map<int, uint32_t> foundOf;
  forEachId(index, [&](VoxelId id) {
    const uint32_t found = components.componentOf(id);
    const int wanted = expected[index.coord(id)];
    REQUIRE(found < components.count());
    REQUIRE(expectedOf.insert({found, wanted}).first->second == wanted);
    REQUIRE(foundOf.insert({wanted, found}).first->second == found);
  });
  REQUIRE(expectedOf.size() == components.count());
}

/// A corridor one voxel wide that runs to and fro through all of the box: one component whose
/// pieces in most leaves meet in other leaves alone.
ObjectVolume serpentine(const CoordBBox& box) {
  ObjectVolume object(box);
  for (int i = 0; i < object.size(); ++i) {
    const Coord d = object.coord(i) - box.min(), last = box.dim() - Coord(1);
    const bool row = d.x() % 2 == 0 && d.y() % 2 == 0;
    const bool turn = d.x() % 2 == 0 && d.z() == (d.y() % 4 == 1 ? last.z() : 0);
    const bool climb = d.y() == (d.x() % 4 == 1 ? last.y() : 0) && d.z() == 0;
    object[i] = row || turn || climb;
  }
  return object;
}

}  // namespace

TEST_CASE("connected_components: drawn by hand", "[connected_components]") {
  CHECK(count(fromPicture("###/..#/###")) == 1);
  CHECK(count(fromPicture("###/.../###")) == 2);
  CHECK(count(fromPicture("#./.#")) == 2);        // along an edge
  CHECK(count(fromPicture("#./..|../.#")) == 2);  // at a corner
  CHECK(count(fromPicture("#.#.#|#.###")) == 2);
  CHECK(count(fromPicture("#.#.#|#####")) == 1);
  // Two arms in one leaf that join in the next one, along each axis.
  const ObjectVolume arms = fromPicture("####/#.../####", {0, 0, 6});
  CHECK(count(arms) == 1);
  CHECK(count(permuted(arms, {{2, 0, 1}, {}})) == 1);
  CHECK(count(permuted(arms, {{1, 2, 0}, {}})) == 1);
  CHECK(count(fromPicture("####/..../####", {0, 0, 6})) == 2);
}

TEST_CASE("connected_components: of edge cases", "[connected_components]") {
  const std::map<std::string, uint32_t> expected = {
      {"no voxels, no box", 0}, {"empty", 0}, {"two components", 2}, {"corner to corner", 2}};
  for (const EdgeCase& c : edgeCases()) {
    INFO(c.name);
    requireComponents(c.object, c.tiles);
    const auto known = expected.find(c.name.substr(0, c.name.find(", tiles")));
    const ConnectedComponents components(LeafIndex(*toMask(c.object, c.tiles)));
    CHECK(components.count() == (known == expected.end() ? 1 : known->second));
  }
}

TEST_CASE("connected_components: agree with a flood fill", "[connected_components]") {
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    Rng rng(seed);
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const Coord size(rng.between(1, 28), rng.between(1, 28), rng.between(1, 28));
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    INFO("seed " << seed << ", " << name(kind) << ", " << toString(object.box()));
    requireComponents(object, seed % 2 ? Tiles::wherePossible : Tiles::none);
  }
}

TEST_CASE("connected_components: a long way round is one component", "[connected_components]") {
  for (const Coord& origin : {Coord(0), Coord(-13, 3, 6)}) {
    ObjectVolume path = serpentine(boxAt(origin, {19, 21, 23}));
    CHECK(count(path) == 1);
    requireComponents(path);
    // Cut in the middle of a row it is two.
    path[origin + Coord(8, 10, 11)] = 0;
    CHECK(count(path) == 2);
    requireComponents(path);
  }
}

TEST_CASE("connected_components: translated and padded they stay", "[connected_components]") {
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const CoordBBox box = boxAt({-6, 1, 40}, {17, 22, 19});
    const ObjectVolume object = randomVolume(VolumeKind::denseNoise, box, rng);
    const uint32_t expected = count(object);
    for (int step = 1; step <= 8; ++step) {
      const ObjectVolume moved = translated(object, Coord(step, -step, 3 * step));
      REQUIRE(count(moved) == expected);
      requireComponents(moved);
    }
    CoordBBox padded = box;
    padded.expand(9);
    REQUIRE(count(withBox(object, padded)) == expected);
    // A copy beyond a gap has as many again.
    CoordBBox two = box;
    two.max().y() += box.dim().y() + 1;
    ObjectVolume twice = withBox(object, two);
    for (int i = 0; i < object.size(); ++i)
      if (object[i]) twice[object.coord(i) + Coord(0, box.dim().y() + 1, 0)] = 1;
    REQUIRE(count(twice) == 2 * expected);
  }
}

TEST_CASE("connected_components: threads do not matter", "[connected_components]") {
  // More leaves than one task takes, on both sides of a border of leaves.
  Rng rng(9);
  const ObjectVolume object =
      randomVolume(VolumeKind::denseNoise, boxAt({-1, -150, 3}, {2, 300, 310}), rng);
  const LeafIndex index(*toMask(object));
  REQUIRE(index.leafCount() > 2048);
  const auto numbers = [&](int threads) {
    const ConnectedComponents components =
        withThreads(threads, [&] { return ConnectedComponents(index); });
    std::vector<uint32_t> all;
    forEachId(index, [&](VoxelId id) { all.push_back(components.componentOf(id)); });
    return all;
  };
  const std::vector<uint32_t> expected = numbers(1);
  for (const int threads : {2, 4, 4}) CHECK((numbers(threads) == expected));
  requireComponents(object);
}

TEST_CASE("connected_components: none once interrupted", "[connected_components]") {
  const LeafIndex index(*toMask(fromPicture("##")));
  StopAtOnce stop;
  CHECK_THROWS_AS(ConnectedComponents(index, &stop), Interrupted);
}
