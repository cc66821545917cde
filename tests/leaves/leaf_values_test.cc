// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_values.h"

#include <array>
#include <random>
#include <vector>

#include "support/catch.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::detail;

/// Words that are empty, full, sparse, dense or anything.
LeafIndex::Mask randomMask(std::mt19937_64& random) {
  LeafIndex::Mask mask;
  for (uint64_t& word : mask) {
    const uint64_t kinds[] = {0, ~uint64_t(0), random() & random() & random(),
                              random() | random() | random(), random()};
    word = kinds[random() % 5];
  }
  return mask;
}

}  // namespace

TEST_CASE("leaf_values: spread over the voxels of a mask and packed again", "[leaf_values]") {
  std::mt19937_64 random(1);
  for (int round = 0; round < 500; ++round) {
    const LeafIndex::Mask mask = randomMask(random);
    std::vector<uint32_t> values, dense;
    for (size_t i = 0; i < 512; ++i) {
      const bool object = mask[i / 64] >> (i % 64) & 1;
      dense.push_back(object ? uint32_t(random()) | 1 : 0);
      if (object) values.push_back(dense.back());
    }
    const size_t count = values.size();
    std::array<uint32_t, 512> spread;
    expandLeaf(mask, values.data(), spread.data());
    CAPTURE(round);
    REQUIRE(std::equal(dense.begin(), dense.end(), spread.begin()));

    // Packing writes no further: what follows may belong to another thread.
    for (size_t i = 0; i < 512; ++i)
      if (!(mask[i / 64] >> (i % 64) & 1)) spread[i] = uint32_t(random());
    std::vector<uint32_t> packed(count + 1, 777);
    packLeaf(mask, spread.data(), packed.data());
    REQUIRE(std::equal(packed.begin(), packed.end() - 1, values.begin()));
    REQUIRE(packed.back() == 777);
  }
}

TEST_CASE("leaf_values: all equal, and all but one", "[leaf_values]") {
  for (size_t count = 1; count <= 512; count = count * 3 / 2 + 1) {
    std::vector<uint32_t> values(count, 7);
    CHECK(allEqual(values.data(), count));
    for (size_t i = 0; i < count && count > 1; ++i) {
      values[i] = 8;
      REQUIRE(!allEqual(values.data(), count));
      values[i] = 7;
    }
  }
}
