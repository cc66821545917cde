// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/leaves/leaf_grid.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/random_volume.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

Coord eightfold(const Coord& p) {
  return {8 * p.x(), 8 * p.y(), 8 * p.z()};
}

/// Everything that the index says, from the voxels.
void requireIndexOf(const LeafIndex& index, const ObjectVolume& object) {
  std::set<Coord> blocks;  // ascending x, then y, then z
  for (int i = 0; i < object.size(); ++i)
    if (object[i]) blocks.insert(object.coord(i) & ~7);
  REQUIRE(index.leafCount() == blocks.size());
  REQUIRE(index.voxelCount() == countObject(object));
  REQUIRE(index.boundingBox().empty() == blocks.empty());
  if (!blocks.empty()) REQUIRE(index.boundingBox() == objectBox(object));
  size_t leaf = 0, rank = 0;
  for (const Coord& origin : blocks) {
    REQUIRE(index.origin(leaf) == origin);
    REQUIRE(index.firstRank(leaf) == rank);
    for (size_t n = 0; n < 6; ++n) {
      const auto found = blocks.find(origin + eightfold(kSixNeighbors[n]));
      const auto expected =
          found == blocks.end() ? LeafIndex::kNone : uint32_t(std::distance(blocks.begin(), found));
      REQUIRE(index.neighbors(leaf)[n] == expected);
    }
    for (int offset = 0; offset < 512; ++offset) {
      const Coord p = index.coord(VoxelId(leaf * 512 + size_t(offset)));
      REQUIRE(p == origin + Coord(offset / 64, offset / 8 % 8, offset % 8));
      const bool active = index.mask(leaf)[size_t(offset / 64)] >> (offset % 64) & 1;
      REQUIRE(active == (object.get(p, 0) != 0));
      REQUIRE(index.rank(VoxelId(leaf * 512 + size_t(offset))) == rank);
      rank += active;
    }
    REQUIRE(index.leafVoxels(leaf) == rank - index.firstRank(leaf));
    ++leaf;
  }
}

/// A sheet that touches more leaves than toGrid() gives to one task.
ObjectVolume manyLeaves() {
  Rng rng(17);
  return randomVolume(VolumeKind::denseNoise, boxAt({-5, -100, -77}, {1, 300, 310}), rng);
}

}  // namespace

TEST_CASE("leaf_index: three voxels, drawn by hand", "[leaf_index]") {
  // One leaf below 0 and two beside each other along z.
  const auto mask = MaskGrid::create();
  for (const Coord& p : {Coord(-1, 0, 7), Coord(2, 3, 4), Coord(2, 3, 5), Coord(1, 0, 8)})
    mask->tree().setValueOn(p);
  const LeafIndex index(*mask);
  REQUIRE(index.leafCount() == 3);
  CHECK(index.voxelCount() == 4);
  CHECK(index.boundingBox() == CoordBBox(Coord(-1, 0, 4), Coord(2, 3, 8)));
  CHECK(index.origin(0) == Coord(-8, 0, 0));
  CHECK(index.origin(1) == Coord(0, 0, 0));
  CHECK(index.origin(2) == Coord(0, 0, 8));
  constexpr uint32_t kNone = LeafIndex::kNone;
  CHECK(index.neighbors(0) == LeafIndex::Neighbors{kNone, 1, kNone, kNone, kNone, kNone});
  CHECK(index.neighbors(1) == LeafIndex::Neighbors{0, kNone, kNone, kNone, kNone, 2});
  CHECK(index.neighbors(2) == LeafIndex::Neighbors{kNone, kNone, kNone, kNone, 1, kNone});
  CHECK(index.mask(0) == LeafIndex::Mask{0, 0, 0, 0, 0, 0, 0, 1u << 7});
  CHECK(index.mask(1) == LeafIndex::Mask{0, 0, 3u << 28, 0, 0, 0, 0, 0});
  CHECK(index.rank(7 * 64 + 7) == 0);
  CHECK(index.rank(512 + 2 * 64 + 3 * 8 + 5) == 2);
  CHECK(index.rank(1024 + 64) == 3);
  CHECK(index.coord(512 + 2 * 64 + 3 * 8 + 5) == Coord(2, 3, 5));
}

TEST_CASE("leaf_index: holds the object's leaves in order, with their neighbors", "[leaf_index]") {
  for (const EdgeCase& c : edgeCases()) {
    INFO(c.name);
    requireIndexOf(LeafIndex(*toMask(c.object, c.tiles)), c.object);
  }
  for (uint64_t seed = 1; seed <= 100; ++seed) {
    Rng rng(seed);
    const Coord size(rng.between(1, 40), rng.between(1, 30), rng.between(1, 30));
    const auto kind = VolumeKind(int(seed) % kVolumeKinds);
    const ObjectVolume object = randomVolume(kind, boxAt(randomOrigin(rng), size), rng);
    INFO("seed " << seed << ", " << name(kind));
    for (const Tiles tiles : {Tiles::none, Tiles::wherePossible})
      requireIndexOf(LeafIndex(*toMask(object, tiles)), object);
  }
}

TEST_CASE("leaf_index: a tile of an internal node is its leaves", "[leaf_index]") {
  const auto mask = MaskGrid::create();
  mask->tree().addTile(2, Coord(-128, 0, 128), true, true);  // 128^3 voxels
  const LeafIndex index(*mask);
  REQUIRE(index.leafCount() == 16 * 16 * 16);
  CHECK(index.voxelCount() == 128 * 128 * 128);
  CHECK(index.boundingBox() == boxAt({-128, 0, 128}, Coord(128)));
  CHECK(index.origin(0) == Coord(-128, 0, 128));
  CHECK(index.origin(17) == Coord(-128, 8, 136));
  CHECK(index.origin(4095) == Coord(-8, 120, 248));
  CHECK(index.neighbors(17)[1] == 17 + 256);
  CHECK(index.neighbors(17)[2] == 1);
  CHECK(index.leafVoxels(17) == 512);
}

TEST_CASE("leaf_index: leaves without an active voxel do not count", "[leaf_index]") {
  const auto mask = MaskGrid::create();
  mask->tree().setValueOn(Coord(3, 3, 3));
  mask->tree().setValueOff(Coord(3, 3, 3));
  mask->tree().touchLeaf(Coord(100, 0, 0));
  CHECK(LeafIndex(*mask).leafCount() == 0);
  mask->tree().setValueOn(Coord(50, 0, 0));
  CHECK(LeafIndex(*mask).leafCount() == 1);
}

TEST_CASE("leaf_index: by whole leaves a translation moves the origins alone", "[leaf_index]") {
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::roughBalls, boxAt({-9, 2, -30}, {25, 33, 41}), rng);
  const Coord by(-16, 4096, 8);
  const LeafIndex before(*toMask(object)), after(*toMask(translated(object, by)));
  REQUIRE(after.leafCount() == before.leafCount());
  for (size_t leaf = 0; leaf < before.leafCount(); ++leaf) {
    REQUIRE(after.origin(leaf) == before.origin(leaf) + by);
    REQUIRE(after.mask(leaf) == before.mask(leaf));
    REQUIRE(after.neighbors(leaf) == before.neighbors(leaf));
    REQUIRE(after.firstRank(leaf) == before.firstRank(leaf));
  }
}

TEST_CASE("leaf_index: objects beyond the limits are refused", "[leaf_index]") {
  const auto mask = MaskGrid::create();
  SECTION("too many leaves, in a tile") {
    mask->tree().addTile(3, Coord(0), true, true);  // 4096^3 voxels
    CHECK_THROWS_AS(LeafIndex(*mask), InvalidInput);
  }
  SECTION("too long") {
    mask->tree().setValueOn(Coord(0, -7, 0));
    mask->tree().setValueOn(Coord(0, kMaxExtent - 8, 0));
    CHECK(LeafIndex(*mask).voxelCount() == 2);
    mask->tree().setValueOn(Coord(0, kMaxExtent - 7, 0));
    CHECK_THROWS_AS(LeafIndex(*mask), InvalidInput);
  }
  SECTION("too far out") {
    mask->tree().setValueOn(Coord(0, 0, -kMaxCoordinate));
    CHECK(LeafIndex(*mask).voxelCount() == 1);
    mask->tree().setValueOn(Coord(0, 0, -kMaxCoordinate - 1));
    CHECK_THROWS_AS(LeafIndex(*mask), InvalidInput);
  }
}

TEST_CASE("leaf_index: counts the bits of a word", "[leaf_index]") {
  CHECK(detail::countBits(0) == 0);
  CHECK(detail::countBits(~uint64_t(0)) == 64);
  Rng rng(3);
  for (int round = 0; round < 1000; ++round) {
    const uint64_t word = rng.next() & (round % 2 ? rng.next() : ~uint64_t(0));
    uint32_t bits = 0;
    for (int bit = 0; bit < 64; ++bit) bits += word >> bit & 1;
    REQUIRE(detail::countBits(word) == bits);
  }
}

TEST_CASE("leaf_index: a grid has the object's voxels and the array's values", "[leaf_index]") {
  std::vector<EdgeCase> cases = edgeCases();
  cases.push_back({"many leaves", manyLeaves(), Tiles::none});
  for (const EdgeCase& c : cases) {
    INFO(c.name);
    const LeafIndex index(*toMask(c.object, c.tiles));
    Rng rng(23);
    DenseVolume<int64_t> values(c.object.box());
    for (int i = 0; i < c.object.size(); ++i) values[i] = rng.below(1000);
    for (const int threads : {1, 4}) {
      const auto signedValues = byRank<int32_t>(index, [&](const Coord& p) { return -values[p]; });
      DenseVolume<int64_t> negative = values;
      for (int i = 0; i < values.size(); ++i) negative[i] = -values[i];
      const auto plain = withThreads(threads, [&] { return toGrid(index, signedValues, "plain"); });
      CHECK(plain->getName() == "plain");
      CHECK(difference("plain", *plain, c.object, negative) == "");
      // The highest bit is not part of the value.
      auto flagged = byRank<uint32_t>(index, [&](const Coord& p) {
        return uint32_t(values[p]) | ((p.x() + p.z()) % 2 ? 1u << 31 : 0);
      });
      const auto copied = withThreads(threads, [&] { return toGrid(index, flagged, "copied"); });
      CHECK(copied->getName() == "copied");
      CHECK(difference("copied", *copied, c.object, values) == "");
      const auto moved =
          withThreads(threads, [&] { return toGrid(index, std::move(flagged), "moved"); });
      CHECK(moved->getName() == "moved");
      CHECK(difference("moved", *moved, c.object, values) == "");
    }
  }
}

TEST_CASE("leaf_index: an object and more voxels", "[leaf_index]") {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed);
    const CoordBBox box =
        boxAt(randomOrigin(rng), Coord(rng.between(1, 30), rng.between(1, 20), 25));
    const ObjectVolume object = randomVolume(VolumeKind(int(seed) % kVolumeKinds), box, rng);
    ObjectVolume both = object, added(box);
    for (int i = 0; i < both.size(); ++i)
      if (!both[i] && rng.chance(0.02)) both[i] = added[i] = 1;
    const LeafIndex before(*toMask(object)), extra(*toMask(added));
    std::vector<LeafIndex::LeafVoxels> more;
    for (size_t leaf = 0; leaf < extra.leafCount(); ++leaf)
      more.push_back({extra.origin(leaf), extra.mask(leaf)});
    const LeafIndex index(before, more);
    INFO("seed " << seed);
    requireIndexOf(index, both);
    for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
      REQUIRE(index.findLeaf(index.origin(leaf)).value() == leaf);
    CHECK_FALSE(index.findLeaf(box.min().offsetBy(-1000) & ~7).has_value());

    // And without them again.
    std::vector<VoxelId> ids;
    DenseVolume<int64_t> values(box);
    for (int i = 0; i < both.size(); ++i) {
      values[i] = 1 + i;
      if (added[i]) ids.push_back(idOf(index, both.coord(i)));
    }
    std::sort(ids.begin(), ids.end());
    const auto grid = toGrid(index, byRank<int32_t>(index, values), "all");
    removeVoxels(*grid, index, ids);
    REQUIRE(difference("grid", *grid, object, values) == "");
    REQUIRE(int64_t(grid->tree().leafCount()) == int64_t(before.leafCount()));
  }
}

TEST_CASE("leaf_index: no grid once interrupted", "[leaf_index]") {
  const LeafIndex index(*toMask(ObjectVolume(boxAt(Coord(-3), Coord(20)), 1)));
  const auto values = byRank<int32_t>(index, [](const Coord& p) { return p.x(); });
  StopAtOnce stop;
  CHECK_THROWS_AS(toGrid(index, values, "none", &stop), Interrupted);
}
