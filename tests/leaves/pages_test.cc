// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/base/detail/pages.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "support/catch.h"

using namespace vdb_madf;

TEST_CASE("pages: what is given back takes nothing with it that is in use", "[pages]") {
  std::mt19937 random(1);
  constexpr size_t kAround = 5000;  // of the same allocation, before and behind the block
  for (const size_t bytes : {size_t(0), size_t(100), size_t(300000), size_t(9) << 20}) {
    for (int round = 0; round < 3; ++round) {
      using Bytes = std::vector<uint8_t, detail::PageAllocator<uint8_t>>;
      Bytes memory(bytes + 2 * kAround);
      const auto valueAt = [](size_t i) { return uint8_t(1 + i % 251); };
      for (size_t i = 0; i < memory.size(); ++i) memory[i] = valueAt(i);

      // Parts of all sizes, given back in any order but the last ones.
      std::vector<size_t> ends{0};
      while (ends.back() < bytes)
        ends.push_back(std::min(bytes, ends.back() + 1 + random() % (bytes / 4 + 1)));
      std::vector<size_t> order(ends.size() - 1);
      std::iota(order.begin(), order.end(), size_t(0));
      std::shuffle(order.begin(), order.end(), random);
      const size_t kept = order.size() / 3;
      detail::PageReturn pages(memory.data() + kAround, bytes);
      for (size_t i = kept; i < order.size(); ++i)
        pages.giveBack(ends[order[i]], ends[order[i] + 1]);

      size_t lost = 0;
      const auto check = [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) lost += memory[i] != valueAt(i);
      };
      check(0, kAround);
      check(kAround + bytes, memory.size());
      for (size_t i = 0; i < kept; ++i)
        check(kAround + ends[order[i]], kAround + ends[order[i] + 1]);
      REQUIRE(lost == 0);
      for (size_t i = 0; i < kept; ++i) pages.giveBack(ends[order[i]], ends[order[i] + 1]);
      check(0, kAround);
      check(kAround + bytes, memory.size());
      REQUIRE(lost == 0);
    }
  }
}

// Sanitizers keep what is freed on purpose, so their program leaves this out, as what is long.
#if defined(__GLIBC__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("pages: freed memory between blocks in use goes back", "[pages][long]") {
  const auto residentBytes = [] {
    int64_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * sysconf(_SC_PAGESIZE);
  };
  constexpr int64_t kBlock = 2000, kCount = 16000;
  std::vector<std::unique_ptr<char[]>> blocks;
  for (int64_t i = 0; i < kCount; ++i) {
    blocks.emplace_back(new char[kBlock]);
    std::fill_n(blocks.back().get(), kBlock, char(1));
  }
  const int64_t before = residentBytes();
  for (size_t i = 0; i < blocks.size(); ++i)
    if (i % 32 != 0) blocks[i].reset();
  detail::returnFreedMemory();
  REQUIRE(residentBytes() < before - kBlock * kCount * 3 / 4);
}
#endif
