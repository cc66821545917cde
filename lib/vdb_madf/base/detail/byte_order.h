// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace vdb_madf::detail {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "files and bit masks are laid out for little-endian machines");

template <typename Word>
void swapWords(void* samples, size_t count) {
  char* place = static_cast<char*>(samples);
  for (size_t i = 0; i < count; ++i, place += sizeof(Word)) {
    Word word;
    std::memcpy(&word, place, sizeof word);
    if constexpr (sizeof(Word) == 2) word = Word(word << 8 | word >> 8);
    if constexpr (sizeof(Word) == 4) word = __builtin_bswap32(word);
    if constexpr (sizeof(Word) == 8) word = __builtin_bswap64(word);
    std::memcpy(place, &word, sizeof word);
  }
}

/// Reverses the bytes of each of `count` samples of `size` bytes.
inline void swapBytes(void* samples, size_t count, size_t size) {
  if (size == 2) swapWords<uint16_t>(samples, count);
  if (size == 4) swapWords<uint32_t>(samples, count);
  if (size == 8) swapWords<uint64_t>(samples, count);
}

}  // namespace vdb_madf::detail
