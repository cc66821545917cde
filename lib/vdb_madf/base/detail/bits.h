// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

namespace vdb_madf::detail {

/// Set bits of a word. Spelled out: without the popcnt instruction, which plain x86-64 lacks, the
/// compiler's own is a call; where a function is built for more, it is recognized.
inline uint32_t countBits(uint64_t word) {
  word -= word >> 1 & 0x5555555555555555u;
  word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
  word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return uint32_t(word * 0x0101010101010101u >> 56);
}

/// Set bits of all words of a list.
template <typename Words>
int64_t countBitsIn(const Words& words) {
  int64_t count = 0;
  for (const uint64_t word : words) count += countBits(word);
  return count;
}

/// f(bit) for the set bits of a word, ascending.
template <typename F>
void forEachBit(uint64_t word, const F& f) {
  for (; word; word &= word - 1) f(__builtin_ctzll(word));
}

/// Eight bytes of 0 or 1 to the eight bits of a byte, the first to the lowest.
inline uint8_t packBits(uint64_t bytes) {
  return uint8_t(bytes * 0x0102040810204080u >> 56);
}

}  // namespace vdb_madf::detail
