// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

namespace vdb_madf::detail {

/// The finalizer of splitmix64 (Steele, Lea, Flood 2014) on the next state: a bijection of 64 bits
/// that serves as counter-based generator. The standard library's distributions differ from one
/// implementation to the next, so samples draw their numbers here.
inline uint64_t mixBits(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A sequence of numbers that is fixed by (seed, stream), on every machine.
class RandomSequence {
 public:
  RandomSequence(uint64_t seed, uint64_t stream) : state_(mixBits(mixBits(seed) + stream)) {}

  /// Real in [0, 1), a multiple of 2^-53.
  double uniform() { return double(mixBits(state_++) >> 11) * 0x1p-53; }
  /// Real in [lower, upper].
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }
  /// Integer in [lower, upper]; the bias is below 2^-37 for ranges of 16 bits.
  int integer(int lower, int upper) { return lower + int(uniform() * (upper - lower + 1)); }
  /// Zero mean, unit variance, nearly normal.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  uint64_t state_;
};

/// White noise on Z^3: a number for each lattice point, whatever box is looked at.
class WhiteNoise {
 public:
  WhiteNoise(uint64_t seed, uint64_t stream) : key_(mixBits(mixBits(seed) + stream)) {}

  /// The key of the points (x, y, *), for the inner loop over z.
  uint64_t row(int x, int y) const { return mixBits(mixBits(key_ + uint32_t(x)) + uint32_t(y)); }

  /// Zero mean, unit variance, nearly normal: the sum of 12 uniforms of 21 bits, exact in integers.
  static float value(uint64_t row, int z) {
    constexpr uint64_t kMask = (1u << 21) - 1;
    const uint64_t key = mixBits(row + uint32_t(z));
    int64_t sum = 0;
    for (uint64_t i = 0; i < 4; ++i) {
      const uint64_t bits = mixBits(key + i);
      sum += int64_t((bits & kMask) + (bits >> 21 & kMask) + (bits >> 42 & kMask));
    }
    return float(double(sum - 12 * (int64_t(1) << 20)) * 0x1p-21);
  }

 private:
  uint64_t key_;
};

}  // namespace vdb_madf::detail
