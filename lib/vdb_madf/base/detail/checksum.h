// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

namespace vdb_madf::detail {

/// A checksum of 64-bit words: two lanes of multiply and xor-shift. It tells contents apart, and is
/// no defense against forgery.
class Checksum {
 public:
  void add(uint64_t word) {
    lanes_[0] = (lanes_[0] ^ word) * 0xff51afd7ed558ccdu;
    lanes_[0] ^= lanes_[0] >> 32;
    lanes_[1] = (lanes_[1] + word) * 0xc4ceb9fe1a85ec53u;
    lanes_[1] ^= lanes_[1] >> 29;
  }
  const std::array<uint64_t, 2>& value() const { return lanes_; }

 private:
  // Any two different odd numbers; these are from the fractional part of the golden ratio.
  std::array<uint64_t, 2> lanes_{0x9e3779b97f4a7c15u, 0xf39cc0605cedc835u};
};

/// Adds bytes as words, the last of them filled up with zeros.
inline void addToChecksum(Checksum& sum, const char* bytes, size_t size) {
  uint64_t word = 0;
  for (; size >= sizeof word; size -= sizeof word, bytes += sizeof word) {
    std::memcpy(&word, bytes, sizeof word);
    sum.add(word);
  }
  if (size == 0) return;
  word = 0;
  std::memcpy(&word, bytes, size);
  sum.add(word);
}

/// The checksum of bytes and their number.
inline std::array<uint64_t, 2> checksumOf(const char* bytes, size_t size) {
  Checksum sum;
  sum.add(size);
  addToChecksum(sum, bytes, size);
  return sum.value();
}

/// 32 hexadecimal digits.
inline std::string checksumText(const std::array<uint64_t, 2>& sum) {
  char text[33];
  std::snprintf(text, sizeof text, "%016" PRIx64 "%016" PRIx64, sum[0], sum[1]);
  return text;
}

}  // namespace vdb_madf::detail
