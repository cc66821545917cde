// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "vdb_madf/base/detail/simd.h"

namespace vdb_madf::detail {

/// How many numbers a kernel works on at a time, on every processor.
constexpr int kLanes = 16;

/// The largest of a vector's numbers, of type T.
template <typename T, int Bytes, typename Vector>
VDB_MADF_KERNEL T largestOf(const Vector& v) {
  if constexpr (Bytes == 16) {
    return std::max(std::max(v[0], v[1]), std::max(v[2], v[3]));
  } else {
    typedef T Half __attribute__((vector_size(Bytes / 2)));  // NOLINT(modernize-use-using)
    Half low, high;
    std::memcpy(&low, &v, Bytes / 2);
    std::memcpy(&high, reinterpret_cast<const char*>(&v) + Bytes / 2, Bytes / 2);
    const Half larger = low > high ? low : high;
    return largestOf<T, Bytes / 2>(larger);
  }
}

/// kLanes numbers in vector registers of that many bytes each. (Of vectors wider than the
/// processor's a compiler makes single numbers, and arrays of numbers it keeps in memory.)
template <int Bytes, typename T = int32_t>
struct Lanes {
  typedef T Vector __attribute__((vector_size(Bytes)));  // NOLINT(modernize-use-using)
  static constexpr int kCount = kLanes * 4 / Bytes;
  Vector v[kCount];

  /// Number: of 4 bytes.
  template <typename Number>
  VDB_MADF_INLINE void load(const Number* from) {
    for (int i = 0; i < kCount; ++i) std::memcpy(&v[i], from + i * (Bytes / 4), Bytes);
  }
  template <typename Number>
  VDB_MADF_INLINE void store(Number* to) const {
    for (int i = 0; i < kCount; ++i) std::memcpy(to + i * (Bytes / 4), &v[i], Bytes);
  }
  VDB_MADF_INLINE void fill(T number) {
    for (int i = 0; i < kCount; ++i) v[i] = Vector{} + number;
  }
  /// All bits set where bit `lane` of `bits` is, none where not.
  VDB_MADF_INLINE void fillFromBits(uint32_t bits) {
    for (int i = 0; i < kCount; ++i) {
      Vector bit;
      for (int j = 0; j < Bytes / 4; ++j) bit[j] = T(1) << (i * (Bytes / 4) + j);
      v[i] = Vector((((Vector{} + T(bits)) & bit) == bit));
    }
  }
  VDB_MADF_INLINE T largest() const {
    Vector most = v[0];
    for (int i = 1; i < kCount; ++i) most = v[i] > most ? v[i] : most;
    return largestOf<T, Bytes>(most);
  }
};

}  // namespace vdb_madf::detail
