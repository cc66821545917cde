// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/voxels_around.h"

#include <random>

#include "support/catch.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

using namespace vdb_madf;

namespace {

/// A set of voxels in 27 leaves; some of them empty or full.
struct RandomSet {
  std::array<LeafIndex::Mask, 27> leaves{};
  std::array<const LeafIndex::Mask*, 27> pointers;

  explicit RandomSet(uint32_t seed) {
    std::mt19937_64 random{seed};
    for (size_t i = 0; i < 27; ++i) {
      pointers[i] = &leaves[i];
      for (uint64_t& word : leaves[i]) {
        if (seed % 4 == 0) word = random() & random() & random();
        if (seed % 4 == 1) word = random() | random() | random();
        if (seed % 4 == 2) word = random();
        if (seed % 4 == 3) word = ~uint64_t(0);
      }
      if (seed % 7 == i % 7) leaves[i] = {};
    }
  }
  /// Of the leaf in the middle, one beyond it at most.
  bool holds(int x, int y, int z) const {
    const auto leaf = [](int t) { return size_t(t + 8) / 8; };
    const auto within = [](int t) { return uint32_t(t + 8) % 8; };
    return detail::holds(leaves[leaf(x) * 9 + leaf(y) * 3 + leaf(z)],
                         within(x) * 64 + within(y) * 8 + within(z));
  }
};

uint32_t countAt(const detail::LeafCounts& counts, uint32_t offset) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < 5; ++i) count |= uint32_t(detail::holds(counts[i], offset)) << i;
  return count;
}

}  // namespace

TEST_CASE("voxels_around: counts, faces and comparisons of every voxel", "[voxels_around]") {
  int largest = 0;
  for (uint32_t seed = 0; seed < 60; ++seed) {
    const RandomSet set(seed), other(seed + 101);
    const detail::VoxelsAround around = detail::voxelsAround(set.pointers);
    const detail::VoxelsAround less = detail::voxelsAround(other.pointers);
    const LeafIndex::Mask greater = detail::isGreater(around.count, less.count);
    const LeafIndex::Mask surrounded = detail::areSurrounded(around);
    detail::LeafCounts mixed = less.count;
    detail::assignCounts(mixed, around.count, set.leaves[13]);
    for (uint32_t offset = 0; offset < 512; ++offset) {
      const int p[3] = {int(offset >> 6), int(offset >> 3 & 7), int(offset & 7)};
      int count = 0;
      bool faces = false;
      for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
          for (int z = -1; z <= 1; ++z) {
            const bool holds = set.holds(p[0] + x, p[1] + y, p[2] + z);
            count += holds;
            faces = faces || (holds && x * x + y * y + z * z == 1);
          }
      REQUIRE(countAt(around.count, offset) == uint32_t(count));
      REQUIRE(detail::holds(around.faces, offset) == faces);
      REQUIRE(detail::holds(surrounded, offset) == (count == 27));
      REQUIRE(detail::holds(greater, offset) == (uint32_t(count) > countAt(less.count, offset)));
      const bool isSet = detail::holds(set.leaves[13], offset);
      REQUIRE(countAt(mixed, offset) == (isSet ? uint32_t(count) : countAt(less.count, offset)));
      largest = std::max(largest, count);
    }
  }
  CHECK(largest == 27);
}
