// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/deal_slabs.h"

#include <map>
#include <memory>
#include <vector>

#include "support/catch.h"
#include "support/thread_team.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// A layer of leaf nodes at z, with a number of voxels along x.
MaskTree layerAt(int z, int voxels) {
  MaskTree layer;
  for (int x = 0; x < voxels; ++x) layer.setValueOn(Coord(x, 3, z + 2));
  return layer;
}

/// Layers by their z; each is read by a member.
using Layers = std::map<int, int>;

struct Dealt {
  std::vector<int> cuts;
  std::vector<std::map<size_t, std::vector<Coord>>>
      leaves;  ///< of each member: what it has of each slab
};

Dealt deal(const Layers& layers, int members, const SlabLimits& limits, int64_t reach,
           const std::optional<Domain>& domain = std::nullopt) {
  Dealt dealt;
  dealt.leaves.resize(size_t(members));
  ThreadTeam team(members);
  asMembers(team, [&](Team& member) {
    MemoryScratch scratch;
    SlabDealer dealer(member, SlabCosts({}), scratch);
    int next = 0;
    for (const auto& [z, voxels] : layers)
      if (next++ % members == member.member()) dealer.add(layerAt(z, voxels));
    dealer.finish(limits, reach, domain);
    const SlabObject object = storedSlabs(scratch, MaskGrid::create());
    if (member.member() == 0) dealt.cuts = object.cuts;
    for (size_t s = 0; s < object.slabCount(); ++s) {
      if (!scratch.has("object-" + std::to_string(s))) continue;
      auto& of = dealt.leaves[size_t(member.member())][s];
      for (const LeafIndex::LeafVoxels& leaf : object.leaves(s)) of.push_back(leaf.origin);
    }
    if (scratch.has("layer-0")) throw std::logic_error("a layer is left");
  });
  return dealt;
}

using Cuts = std::vector<int>;
using Places = std::vector<Coord>;

}  // namespace

TEST_CASE("dealt slabs: about as much for each member, within the limits", "[slabs]") {
  const Layers layers{{-8, 6}, {0, 6}, {8, 6}, {16, 6}, {24, 6}, {40, 6}};
  const int64_t two = 2 * SlabCosts({}).of(1, 6, 5 * 512 / 216);
  CHECK(deal(layers, 1, {}, 0).cuts == Cuts{-8, 48});
  CHECK(deal(layers, 3, {}, 0).cuts == Cuts{-8, 8, 24, 48});
  CHECK(deal(layers, 2, {0, 8, 8}, 0).cuts == Cuts{-8, 0, 8, 16, 24, 32, 40, 48});
  CHECK(deal(layers, 1, {two, 0, 8}, 0).cuts == Cuts{-8, 8, 24, 48});
  CHECK(deal(layers, 1, {two - 1, 0, 8}, 0).cuts == Cuts{-8, 0, 8, 16, 24, 40, 48});
  CHECK(deal(layers, 1, {two, 0, 24}, 0).cuts == Cuts{-8, 16, 40, 48});
  CHECK(deal({}, 2, {}, 0).cuts == Cuts{0, 8});
  const Domain domain(CoordBBox(Coord(0, 0, -20), Coord(9, 9, 60)));
  CHECK(deal(layers, 1, {}, 0, domain).cuts == Cuts{-24, 64});
}

TEST_CASE("dealt slabs: what the whole takes is not left for a slab", "[slabs]") {
  ThreadTeam team(2);
  const SlabCosts costs({});
  std::vector<MaskTree> layers(4);  // with a speck in each leaf node
  for (size_t i = 0; i < layers.size(); ++i)
    for (int x = 0; x < 3; ++x) layers[i].setValueOn(Coord(8 * x + 3, 3, 8 * int(i) + 3));
  std::vector<LeafIndex::LeafVoxels> leaves;
  const LeafCosts layer = addLeaves(layers[0], costs, leaves);
  REQUIRE(layer.ofWhole >= 3 * costs.speck);
  const int64_t whole = 4 * layer.ofWhole;
  const auto cutsFor = [&](int64_t bytes) {
    Cuts cuts;
    asMembers(team, [&](Team& member) {
      MemoryScratch scratch;
      SlabDealer dealer(member, costs, scratch);
      for (size_t i = size_t(member.member()); i < layers.size(); i += 2) dealer.add(layers[i]);
      dealer.finish({bytes, 0, 8}, 0, {});
      if (member.member() == 0) cuts = storedSlabs(scratch, MaskGrid::create()).cuts;
    });
    return cuts;
  };
  CHECK(cutsFor(2 * layer.ofSlab + whole) == Cuts{0, 16, 32});
  CHECK(cutsFor(2 * layer.ofSlab + whole - 1) == Cuts{0, 8, 16, 24, 32});
  CHECK(cutsFor(1) == Cuts{0, 8, 16, 24, 32});
}

TEST_CASE("dealt slabs: a member has its own, and what lies within reach", "[slabs]") {
  const Layers layers{{0, 1}, {8, 30}, {16, 1}, {24, 1}, {32, 1}, {40, 1}};
  const Dealt own = deal(layers, 3, {0, 16, 8}, 0);
  REQUIRE(own.cuts == Cuts{0, 8, 16, 32, 48});
  REQUIRE(own.leaves[0].size() == 2);
  CHECK(own.leaves[0].at(0) == Places{{0, 0, 0}});
  CHECK(own.leaves[0].at(1) == Places{{0, 0, 8}, {8, 0, 8}, {16, 0, 8}, {24, 0, 8}});
  CHECK(own.leaves[1].size() == 1);
  CHECK(own.leaves[1].at(2) == Places{{0, 0, 16}, {0, 0, 24}});
  CHECK(own.leaves[2].size() == 1);
  const Dealt wide = deal(layers, 3, {0, 16, 8}, 1);
  REQUIRE(wide.leaves[1].size() == 3);
  CHECK(wide.leaves[1].at(1) == Places{{0, 0, 8}, {8, 0, 8}, {16, 0, 8}, {24, 0, 8}});
  CHECK(wide.leaves[1].at(2) == Places{{0, 0, 16}, {0, 0, 24}});
  CHECK(wide.leaves[1].at(3) == Places{{0, 0, 32}});
  CHECK(deal(layers, 3, {0, 16, 8}, 9).leaves[1].size() == 4);
}

TEST_CASE("dealt slabs: layers are single, and each comes once", "[slabs]") {
  Team alone;
  MemoryScratch scratch;
  SlabDealer dealer(alone, SlabCosts({}), scratch);
  dealer.add(layerAt(8, 3));
  dealer.add(MaskTree());
  dealer.add(layerAt(0, 3));
  CHECK_THROWS_AS(dealer.add(layerAt(8, 3)), InvalidInput);
  MaskTree two = layerAt(16, 1);
  two.setValueOn(Coord(0, 0, 24));
  CHECK_THROWS_AS(dealer.add(two), InvalidInput);
}
