// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/kernels/distance_rows.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/catch.h"

namespace {

using namespace vdb_madf::detail;

// Weights of an axis. The largest stays below 2^31 with the longest row's square.
constexpr int kWeights[] = {1, 2, 144, 100000};

size_t rowIndex(int t, int row) {
  return size_t(t) * 64 + size_t(row);
}

/// What the passes but the first one are to find. Slab 0 of `in` is position -1.
uint32_t leastByDefinition(const std::vector<uint32_t>& in, int length, int weight, int row,
                           int t) {
  uint32_t least = kInfinite;
  for (int s = -1; s <= length; ++s)
    least = std::min(least, in[rowIndex(s + 1, row)] + uint32_t(weight * (s - t) * (s - t)));
  return least;
}

/// Runs the kernel with what it wants to know of the rows.
void widenRows(const std::vector<uint32_t>& in, int length, int begin, int end, int weight,
               int reach, std::vector<uint32_t>& out) {
  const uint32_t* const first = in.data() + 64;
  widenWindows(first, leastOfRows(first, length), length, begin, end, weight, reach, out.data());
}

}  // namespace

TEST_CASE("distance_rows: the first pass by its definition", "[distance_rows]") {
  std::mt19937 random(1);
  for (const int length : {8, 24, 80}) {
    for (int i = 0; i < 40; ++i) {
      const int weight = kWeights[i / 2 % 4];
      const int begin = i % 2 ? int(random() % 4) : 0, end = length - int(random() % 4);
      // Only where the domain reaches an end of the rows, it can go on behind it.
      RowDomain domain{begin, end, {}, {}};
      for (size_t row = 0; row < 64; ++row) {
        domain.before[row] = begin == 0 && (i + row) % 3 ? 0 : kInfinite;
        domain.after[row] = end == length && (i + row) % 5 ? 0 : kInfinite;
      }
      std::vector<uint64_t> masks(size_t(length), ~uint64_t(0));
      for (int t = 0; t < length; ++t)
        masks[size_t(t)] =
            t >= begin && t < end ? uint64_t(random()) << 32 | random() | ~0u >> i : 0;
      std::vector<uint32_t> out(masks.size() * 64);
      scanRows(masks.data(), length, domain, weight, out.data());
      // -1: before the rows, length: after them.
      const auto isBackground = [&](int t, int row) {
        if (t < 0) return domain.before[size_t(row)] == 0;
        if (t >= length) return domain.after[size_t(row)] == 0;
        return t >= begin && t < end && !(masks[size_t(t)] >> row & 1);
      };
      int wrong = 0;
      for (int t = begin; t < end; ++t) {
        for (int row = 0; row < 64; ++row) {
          uint32_t expected = kInfinite;
          for (int s = -1; s <= length; ++s)
            if (isBackground(s, row))
              expected = std::min(expected, uint32_t(weight * (s - t) * (s - t)));
          wrong += out[rowIndex(t, row)] != expected;
        }
      }
      REQUIRE(wrong == 0);
    }
  }
}

TEST_CASE("distance_rows: the other passes by their definition", "[distance_rows]") {
  std::mt19937 random(2);
  for (const int length : {8, 16, 104}) {
    for (int i = 0; i < 80; ++i) {
      const int weight = kWeights[i % 4];
      // Few small values, so that windows grow wide; some rows have none.
      std::vector<uint32_t> in((size_t(length) + 2) * 64, kInfinite), out(size_t(length) * 64);
      for (uint32_t& value : in)
        if (random() % unsigned(2 + 5 * i) == 0) value = random() % unsigned(500 * weight);
      const int reach = i % 3 ? int(random() % 30) : length + 1;
      const auto known = uint32_t(weight * reach * reach);
      widenRows(in, length, 0, length, weight, reach, out);
      int wrong = 0;
      for (int t = 0; t < length; ++t) {
        for (int row = 0; row < 64; ++row) {
          const uint32_t expected = leastByDefinition(in, length, weight, row, t);
          if (expected <= known)
            wrong += out[rowIndex(t, row)] != expected;
          else
            wrong += out[rowIndex(t, row)] <= known;
        }
      }
      REQUIRE(wrong == 0);
    }
  }
}

TEST_CASE("distance_rows: background hundreds of voxels away", "[distance_rows]") {
  std::mt19937 random(3);
  constexpr int kLength = 600;
  for (const int weight : {1, 2, 144}) {
    std::vector<uint32_t> in((kLength + 2) * 64, kInfinite), out(kLength * 64, 7);
    for (uint32_t& value : in)
      if (random() % 400 == 0) value = random() % unsigned(90000 * weight);
    for (int t = -1; t <= kLength; ++t) in[rowIndex(t + 1, 5)] = kInfinite;
    const int begin = 16, end = kLength - 8;
    widenRows(in, kLength, begin, end, weight, kLength, out);
    int wrong = 0;
    for (int t = 0; t < kLength; ++t)
      for (int row = 0; row < 64; ++row) {
        const uint32_t expected = leastByDefinition(in, kLength, weight, row, t);
        wrong += out[rowIndex(t, row)] != (t < begin || t >= end ? 7 : expected);
      }
    REQUIRE(wrong == 0);
  }
}

TEST_CASE("distance_rows: thick rows, with background beyond their ends or nowhere",
          "[distance_rows]") {
  std::mt19937 random(4);
  for (int i = 0; i < 24; ++i) {
    const int length = 8 * (1 + int(random() % 20)), weight = kWeights[i % 3];
    const auto far = unsigned(weight * length * length / 2);
    std::vector<uint32_t> in(size_t(length + 2) * 64), out(size_t(length) * 64);
    for (uint32_t& value : in) value = far / 2 + random() % far;
    const std::vector<uint32_t> ends = {0, kInfinite, far / 3};
    for (int row = 0; row < 64; ++row) {
      in[rowIndex(0, row)] = ends[random() % 3];
      in[rowIndex(length + 1, row)] = ends[random() % 3];
    }
    widenRows(in, length, 0, length, weight, length + 1, out);
    int wrong = 0;
    for (int t = 0; t < length; ++t)
      for (int row = 0; row < 64; ++row) {
        const uint32_t expected = leastByDefinition(in, length, weight, row, t);
        wrong += out[rowIndex(t, row)] != expected;
      }
    REQUIRE(wrong == 0);
  }
}
