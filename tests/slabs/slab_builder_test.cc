// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/slab_builder.h"

#include <vector>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;

/// A layer of leaf nodes at z, with that many voxels in each of two leaves.
MaskTree twoLeavesAt(int z, int voxels) {
  MaskTree layer;
  for (int i = 0; i < voxels; ++i) {
    layer.setValueOn(Coord(-16 + i % 8, i / 8, z + 7));
    layer.setValueOn(Coord(40 + i % 8, i / 8, z));
  }
  return layer;
}

SlabObject built(const SlabLimits& limits, const std::vector<int>& layers, Scratch& scratch,
                 const std::optional<Domain>& domain = std::nullopt) {
  SlabBuilder builder(limits, SlabCosts({}), scratch);
  for (const int z : layers) builder.add(twoLeavesAt(z, 10));
  CHECK_FALSE(hasSlabs(scratch));
  builder.finish(domain);
  CHECK(hasSlabs(scratch));
  return storedSlabs(scratch, MaskGrid::create());
}

}  // namespace

TEST_CASE("slab builder: cuts where a slab would be too high or too full", "[slabs]") {
  using Cuts = std::vector<int>;
  const auto cuts = [](int64_t bytes, int height, int leastHeight) {
    MemoryScratch scratch;
    return built({bytes, height, leastHeight}, {-16, -8, 0, 8, 24, 32}, scratch).cuts;
  };
  const int64_t layer = SlabCosts({}).of(2, 20, 0);
  CHECK(cuts(0, 0, 8) == Cuts{-16, 40});
  CHECK(cuts(0, 8, 8) == Cuts{-16, -8, 0, 8, 24, 32, 40});
  CHECK(cuts(0, 9, 8) == Cuts{-16, 0, 24, 40});
  CHECK(cuts(2 * layer, 0, 8) == Cuts{-16, 0, 24, 40});
  CHECK(cuts(1, 0, 8) == Cuts{-16, -8, 0, 8, 24, 32, 40});  // a layer is not divided
  CHECK(cuts(1, 0, 20) == Cuts{-16, 8, 32, 40});
}

TEST_CASE("slab builder: slabs hold the layers, and cover the domain", "[slabs]") {
  MemoryScratch scratch;
  const Domain domain(CoordBBox(Coord(-20, 0, -30), Coord(60, 9, 50)));
  const SlabObject object = built({0, 16, 8}, {-16, -8, 0, 8}, scratch, domain);
  CHECK(object.cuts == std::vector<int>{-32, 0, 56});
  REQUIRE(object.slabCount() == 2);
  const auto leaves = object.leaves(0);
  REQUIRE(leaves.size() == 4);
  CHECK(leaves[0].origin == Coord(-16, 0, -16));
  CHECK(leaves[1].origin == Coord(-16, 0, -8));
  CHECK(leaves[2].origin == Coord(40, 0, -16));
  CHECK(leaves[0].mask[0] == (uint64_t(1) << 7 | uint64_t(1) << 15));
  CHECK(leaves[0].mask[2] == uint64_t(1) << 7);
  MemoryScratch empty;
  CHECK(built({}, {}, empty, domain).cuts == std::vector<int>{-32, 56});
  MemoryScratch unbounded;
  CHECK(built({}, {}, unbounded).slabCount() == 1);
}

TEST_CASE("slab builder: layers are single, and ascend", "[slabs]") {
  MemoryScratch scratch;
  SlabBuilder builder({}, SlabCosts({}), scratch);
  builder.add(twoLeavesAt(8, 3));
  builder.add(MaskTree());
  CHECK_THROWS_AS(builder.add(twoLeavesAt(8, 3)), InvalidInput);
  MaskTree two = twoLeavesAt(16, 1);
  two.setValueOn(Coord(0, 0, 24));
  CHECK_THROWS_AS(SlabBuilder({}, SlabCosts({}), scratch).add(two), InvalidInput);
  MaskTree tile;
  tile.fill(CoordBBox(Coord(0), Coord(7)), true);
  if (tile.activeTileCount() > 0)
    CHECK_THROWS_AS(SlabBuilder({}, SlabCosts({}), scratch).add(tile), InvalidInput);
}

TEST_CASE("slab builder: counts voxels of thin structures apart", "[slabs]") {
  const auto bytes = [](const CoordBBox& box) {
    MaskTree layer;
    for (auto p = box.begin(); p; ++p) layer.setValueOn(*p);
    std::vector<LeafIndex::LeafVoxels> leaves;
    return addLeaves(layer, SlabCosts({}), leaves).ofSlab;
  };
  CHECK(bytes({Coord(0), Coord(7)}) == SlabCosts({}).of(1, 512, 0));
  // 6 and 24 of 216 that are not at faces of the leaf.
  CHECK(bytes({Coord(2, 2, 0), Coord(2, 2, 7)}) == SlabCosts({}).of(1, 8, 6 * 512 / 216));
  CHECK(bytes({Coord(2, 2, 0), Coord(3, 3, 7)}) == SlabCosts({}).of(1, 32, 24 * 512 / 216));
  // Of 3 x 3 those at the edges have none inside beside them.
  CHECK(bytes({Coord(2, 2, 0), Coord(4, 4, 7)}) == SlabCosts({}).of(1, 72, 24 * 512 / 216));
}
