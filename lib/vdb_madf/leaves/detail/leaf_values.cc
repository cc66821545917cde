// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_values.h"

#include <cstring>

#include "vdb_madf/base/detail/simd.h"

#ifdef VDB_MADF_SIMD_V4
#include <immintrin.h>
#endif

namespace vdb_madf::detail {

namespace {

// No branches on single voxels: a mispredicted one costs more than ten of these steps.

void expandPortable(const LeafIndex::Mask& mask, const uint32_t* values, uint32_t* dense) {
  for (size_t x = 0; x < 8; ++x, dense += 64) {
    uint64_t word = mask[x];
    if (word == ~uint64_t(0)) {
      std::memcpy(dense, values, 64 * sizeof(uint32_t));
      values += 64;
    } else {
      for (size_t bit = 0; bit < 64; ++bit, word >>= 1) {
        dense[bit] = *values & (0u - uint32_t(word & 1));
        values += word & 1;
      }
    }
  }
}

/// Returns the end of what was written; writes one value past it.
uint32_t* packPortable(const LeafIndex::Mask& mask, const uint32_t* dense, uint32_t* values) {
  for (size_t x = 0; x < 8; ++x, dense += 64) {
    uint64_t word = mask[x];
    if (word == ~uint64_t(0)) {
      std::memcpy(values, dense, 64 * sizeof(uint32_t));
      values += 64;
    } else {
      for (size_t bit = 0; bit < 64; ++bit, word >>= 1) {
        *values = dense[bit];
        values += word & 1;
      }
    }
  }
  return values;
}

#ifdef VDB_MADF_SIMD_V4
__attribute__((target("arch=x86-64-v4"))) void expandV4(const LeafIndex::Mask& mask,
                                                        const uint32_t* values, uint32_t* dense) {
  for (size_t x = 0; x < 8; ++x) {
    for (size_t lane = 0; lane < 64; lane += 16, dense += 16) {
      const __mmask16 inside = __mmask16(mask[x] >> lane);
      _mm512_storeu_si512(dense, _mm512_maskz_expand_epi32(inside, _mm512_loadu_si512(values)));
      values += __builtin_popcount(inside);
    }
  }
}

/// Writes up to 16 values past the end that it returns.
__attribute__((target("arch=x86-64-v4"))) uint32_t* packV4(const LeafIndex::Mask& mask,
                                                           const uint32_t* dense,
                                                           uint32_t* values) {
  for (size_t x = 0; x < 8; ++x) {
    for (size_t lane = 0; lane < 64; lane += 16, dense += 16) {
      const __mmask16 inside = __mmask16(mask[x] >> lane);
      _mm512_storeu_si512(values, _mm512_maskz_compress_epi32(inside, _mm512_loadu_si512(dense)));
      values += __builtin_popcount(inside);
    }
  }
  return values;
}
#endif

}  // namespace

VDB_MADF_SIMD bool allEqual(const uint32_t* values, size_t count) {
  uint32_t differ = 0;
  for (size_t i = 0; i < count; ++i) differ |= values[i] ^ values[0];
  return differ == 0;
}

void expandLeaf(const LeafIndex::Mask& mask, const uint32_t* values, uint32_t* dense) {
#ifdef VDB_MADF_SIMD_V4
  if (__builtin_cpu_supports("avx512vl")) return expandV4(mask, values, dense);
#endif
  expandPortable(mask, values, dense);
}

void packLeaf(const LeafIndex::Mask& mask, const uint32_t* dense, uint32_t* values) {
  // Not in place: the next leaf's values may be another thread's.
  uint32_t packed[512 + 16];
  uint32_t* end;
#ifdef VDB_MADF_SIMD_V4
  if (__builtin_cpu_supports("avx512vl"))
    end = packV4(mask, dense, packed);
  else
#endif
    end = packPortable(mask, dense, packed);
  std::memcpy(values, packed, size_t(end - packed) * sizeof(uint32_t));
}

}  // namespace vdb_madf::detail
