// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_values.h"

#include <array>
#include <cstring>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

#ifdef VDB_MADF_SIMD_LEVELS
#include <immintrin.h>
#endif

namespace vdb_madf::detail {

namespace {

// No branches on single voxels: a mispredicted one costs more than ten of these steps. Nothing is
// read past the last value: the next leaf's may be written at the same time.

void expandPortable(const uint64_t* words, size_t count, const uint32_t* packed, uint32_t* dense) {
  uint32_t copied[512 + 1];  // as one is read past the last
  size_t all = 0;
  for (size_t x = 0; x < count; ++x) all += countBits(words[x]);
  std::memcpy(copied, packed, all * sizeof(uint32_t));
  copied[all] = 0;
  const uint32_t* values = copied;
  for (size_t x = 0; x < count; ++x, dense += 64) {
    uint64_t word = words[x];
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

#ifdef VDB_MADF_SIMD_LEVELS
/// Permutations of 8 lanes, a byte each, by the mask of the lanes that are object voxels.
using Permutations = std::array<uint64_t, 256>;

/// Lane i: how many object lanes come before it.
constexpr Permutations spreadingLanes() {
  Permutations lanes{};
  for (uint32_t mask = 0; mask < 256; ++mask) {
    uint64_t before = 0;
    for (uint32_t lane = 0; lane < 8; ++lane) {
      lanes[mask] |= before << (8 * lane);
      before += mask >> lane & 1;
    }
  }
  return lanes;
}

/// Lane i: the object lane that i others come before.
constexpr Permutations packingLanes() {
  Permutations lanes{};
  for (uint32_t mask = 0; mask < 256; ++mask) {
    uint32_t before = 0;
    for (uint64_t lane = 0; lane < 8; ++lane)
      if (mask >> lane & 1) lanes[mask] |= lane << (8 * before++);
  }
  return lanes;
}

constexpr Permutations kSpreading = spreadingLanes(), kPacking = packingLanes();

__attribute__((target("arch=x86-64-v3"))) inline __m256i permuted(__m256i values, uint64_t lanes) {
  return _mm256_permutevar8x32_epi32(values,
                                     _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(int64_t(lanes))));
}

__attribute__((target("arch=x86-64-v3"))) void expandV3(const uint64_t* words, size_t count,
                                                        const uint32_t* values, uint32_t* dense) {
  const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  for (size_t x = 0; x < count; ++x, dense += 64) {
    if (words[x] == ~uint64_t(0)) {
      std::memcpy(dense, values, 64 * sizeof(uint32_t));
      values += 64;
      continue;
    }
    for (size_t lane = 0; lane < 64; lane += 8) {
      const uint32_t inside = uint32_t(words[x] >> lane & 0xff);
      const __m256i object =
          _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(int(inside)), bits), bits);
      const int held = __builtin_popcount(inside);
      const __m256i packed = _mm256_maskload_epi32(
          reinterpret_cast<const int*>(values), _mm256_cmpgt_epi32(_mm256_set1_epi32(held), lanes));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(dense + lane),
                          _mm256_and_si256(permuted(packed, kSpreading[inside]), object));
      values += held;
    }
  }
}

/// Writes up to 8 values past the end that it returns.
__attribute__((target("arch=x86-64-v3"))) uint32_t* packV3(const LeafIndex::Mask& mask,
                                                           const uint32_t* dense,
                                                           uint32_t* values) {
  for (size_t x = 0; x < 8; ++x, dense += 64) {
    if (mask[x] == ~uint64_t(0)) {
      std::memcpy(values, dense, 64 * sizeof(uint32_t));
      values += 64;
      continue;
    }
    for (size_t lane = 0; lane < 64; lane += 8) {
      const uint32_t inside = uint32_t(mask[x] >> lane & 0xff);
      const __m256i spread = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(dense + lane));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(values), permuted(spread, kPacking[inside]));
      values += __builtin_popcount(inside);
    }
  }
  return values;
}

__attribute__((target("arch=x86-64-v4"))) void expandV4(const uint64_t* words, size_t count,
                                                        const uint32_t* values, uint32_t* dense) {
  for (size_t x = 0; x < count; ++x) {
    for (size_t lane = 0; lane < 64; lane += 16, dense += 16) {
      const __mmask16 inside = __mmask16(words[x] >> lane);
      const int held = __builtin_popcount(inside);
      // (One instruction loads and expands, but in microcode on some processors.)
      const __m512i packed = _mm512_maskz_loadu_epi32(__mmask16((1u << held) - 1), values);
      _mm512_storeu_si512(dense, _mm512_maskz_expand_epi32(inside, packed));
      values += held;
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

/// As the processor can.
void expandWith(const uint64_t* words, size_t count, const uint32_t* values, uint32_t* dense) {
#ifdef VDB_MADF_SIMD_LEVELS
  if (bestSimdLevel() == SimdLevel::v4) return expandV4(words, count, values, dense);
  if (bestSimdLevel() == SimdLevel::v3) return expandV3(words, count, values, dense);
#endif
  expandPortable(words, count, values, dense);
}

uint32_t* packWith(const LeafIndex::Mask& mask, const uint32_t* dense, uint32_t* values) {
#ifdef VDB_MADF_SIMD_LEVELS
  if (bestSimdLevel() == SimdLevel::v4) return packV4(mask, dense, values);
  if (bestSimdLevel() == SimdLevel::v3) return packV3(mask, dense, values);
#endif
  return packPortable(mask, dense, values);
}

VDB_MADF_KERNEL bool allEqualKernel(const uint32_t* values, size_t count) {
  uint32_t differ = 0;
  for (size_t i = 0; i < count; ++i) differ |= values[i] ^ values[0];
  return differ == 0;
}

VDB_MADF_KERNEL LeafIndex::Mask equalTo(const uint32_t* dense, uint32_t value) {
  uint8_t equal[512];
  for (size_t i = 0; i < 512; ++i) equal[i] = dense[i] == value;
  LeafIndex::Mask mask;
  for (size_t x = 0; x < 8; ++x) mask[x] = wordOfBytes(equal + x * 64);
  return mask;
}

}  // namespace

LeafIndex::Mask voxelsOf(const uint32_t* dense, uint32_t value) {
  return atBestLevel([&]() VDB_MADF_INLINE { return equalTo(dense, value); });
}

bool allEqual(const uint32_t* values, size_t count) {
  return atBestLevel([&]() VDB_MADF_INLINE { return allEqualKernel(values, count); });
}

void expandLeaf(const LeafIndex::Mask& mask, const uint32_t* values, uint32_t* dense) {
  expandWith(mask.data(), mask.size(), values, dense);
}

void expandWord(uint64_t word, const uint32_t* values, uint32_t* dense) {
  expandWith(&word, 1, values, dense);
}

void packLeaf(const LeafIndex::Mask& mask, const uint32_t* dense, uint32_t* values) {
  // Not in place: the next leaf's values may be another thread's.
  uint32_t packed[512 + 16];
  const uint32_t* end = packWith(mask, dense, packed);
  std::memcpy(values, packed, size_t(end - packed) * sizeof(uint32_t));
}

}  // namespace vdb_madf::detail
