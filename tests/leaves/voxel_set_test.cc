// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <atomic>
#include <set>
#include <thread>
#include <vector>

#include "support/by_rank.h"
#include "support/catch.h"
#include "support/edge_cases.h"
#include "support/random_volume.h"
#include "vdb_madf/leaves/voxel_set.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// All that a ranked set says, against the same members in a std::set.
void requireSameVoxels(const VoxelSet& set, const std::set<VoxelId>& expected, size_t leaves) {
  REQUIRE(set.size() == expected.size());
  REQUIRE(set.members() == std::vector<VoxelId>(expected.begin(), expected.end()));
  REQUIRE(set.wordCount() == leaves * 8);
  uint32_t before = 0;
  for (VoxelId id = 0; id < leaves * 512; ++id) {
    const bool member = expected.count(id) > 0;
    REQUIRE(set.contains(id) == member);
    REQUIRE((set.word(id / 64) >> id % 64 & 1) == member);
    REQUIRE(set.rank(id) == before);  // of a voxel that is no member: the members before it
    before += member;
  }
}

}  // namespace

TEST_CASE("voxel_set: four members, drawn by hand", "[voxel_set]") {
  VoxelSet set(2);
  CHECK(set.wordCount() == 16);
  for (const VoxelId id : {1023u, 0u, 64u, 63u}) set.insert(id);
  set.rankMembers();
  CHECK(set.size() == 4);
  CHECK(set.members() == std::vector<VoxelId>{0, 63, 64, 1023});
  CHECK(set.rank(0) == 0);
  CHECK(set.rank(63) == 1);
  CHECK(set.rank(64) == 2);
  CHECK(set.rank(500) == 3);
  CHECK(set.rank(1023) == 3);
  CHECK(set.word(0) == (uint64_t(1) << 63 | 1));
  set.erase(63);
  set.insert(64);  // is a member already
  set.erase(65);   // is none
  set.rankMembers();
  CHECK(set.members() == std::vector<VoxelId>{0, 64, 1023});
  CHECK(set.rank(1023) == 2);
}

TEST_CASE("voxel_set: empty and full ones", "[voxel_set]") {
  VoxelSet none;
  none.rankMembers();
  requireSameVoxels(none, {}, 0);
  VoxelSet empty(3), full(3);
  std::set<VoxelId> all;
  for (VoxelId id = 0; id < 3 * 512; ++id) {
    full.insert(id);
    all.insert(id);
  }
  empty.rankMembers();
  full.rankMembers();
  requireSameVoxels(empty, {}, 3);
  requireSameVoxels(full, all, 3);
}

TEST_CASE("voxel_set: agrees with a std::set", "[voxel_set]") {
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const size_t leaves = size_t(rng.between(1, 6));
    VoxelSet set(leaves);
    std::set<VoxelId> expected;
    for (int round = 0; round < 3; ++round) {  // ranked, changed, ranked again
      for (int step = rng.between(0, 700); step > 0; --step) {
        const auto id = VoxelId(rng.below(int(leaves) * 512));
        const int change = rng.below(4);
        if (change == 0) {
          set.erase(id);
          expected.erase(id);
        } else {
          change == 1 ? set.insertAtomic(id) : set.insert(id);
          expected.insert(id);
        }
      }
      set.rankMembers();
      requireSameVoxels(set, expected, leaves);
    }
  }
}

TEST_CASE("voxel_set: a word may be written as a whole", "[voxel_set]") {
  VoxelSet set(2);
  set.insert(700);
  set.word(3) = 0xf0;
  set.word(700 / 64) = 0;
  set.rankMembers();
  requireSameVoxels(set, {3 * 64 + 4, 3 * 64 + 5, 3 * 64 + 6, 3 * 64 + 7}, 2);
}

TEST_CASE("voxel_set: holds the voxels of an object in the order of its ranks", "[voxel_set]") {
  for (const EdgeCase& c : edgeCases()) {
    INFO(c.name);
    const LeafIndex index(*toMask(c.object, c.tiles));
    VoxelSet set(index.leafCount());
    for (int i = 0; i < c.object.size(); ++i)
      if (c.object[i]) set.insert(idOf(index, c.object.coord(i)));
    set.rankMembers();
    REQUIRE(set.size() == size_t(index.voxelCount()));
    for (const VoxelId id : set.members()) REQUIRE(set.rank(id) == index.rank(id));
  }
}

TEST_CASE("voxel_set: threads may insert at a time", "[voxel_set]") {
  // Two go from word to word together, one with the odd bits and one with the even ones.
  constexpr size_t kLeaves = 500;
  for (int round = 0; round < 30; ++round) {
    VoxelSet set(kLeaves);
    std::atomic<VoxelId> arrived{0};
    const auto insertBits = [&](VoxelId first) {
      for (VoxelId word = 0; word < kLeaves * 8; ++word) {
        ++arrived;
        while (arrived < 2 * (word + 1)) std::this_thread::yield();
        for (VoxelId bit = first; bit < 64; bit += 2) set.insertAtomic(word * 64 + bit);
      }
    };
    std::thread other(insertBits, 1);
    insertBits(0);
    other.join();
    set.rankMembers();
    REQUIRE(set.size() == kLeaves * 512);
  }
}
