// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

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

}  // namespace vdb_madf::detail
