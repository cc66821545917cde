// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/voxels_around.h"

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

using Mask = LeafIndex::Mask;

VDB_MADF_KERNEL uint64_t majority(uint64_t a, uint64_t b, uint64_t c) {
  return (a & b) | (c & (a | b));
}

/// Words of one x of a leaf and of those beside it along z: the voxels before and behind each one.
VDB_MADF_KERNEL uint64_t before(uint64_t word, uint64_t wordBefore) {
  return (word << 1 & ~kFirstZ) | (wordBefore >> 7 & kFirstZ);
}
VDB_MADF_KERNEL uint64_t behind(uint64_t word, uint64_t wordBehind) {
  return (word >> 1 & ~kLastZ) | (wordBehind << 7 & kLastZ);
}

/// The last row (of y = 7) of one word and the first one of another, as the first two rows of one.
VDB_MADF_KERNEL uint64_t outerRows(uint64_t lower, uint64_t upper) {
  return lower >> 56 | (upper & kFirstY) << 8;
}
/// The rows one down, one up; those that come in are of outerRows.
VDB_MADF_KERNEL uint64_t lowerRows(uint64_t word, uint64_t outer) {
  return word << 8 | (outer & kFirstY);
}
VDB_MADF_KERNEL uint64_t upperRows(uint64_t word, uint64_t outer) {
  return word >> 8 | (outer >> 8) << 56;
}

constexpr size_t kPlanes = 10;  // x from -1 to 8

VDB_MADF_KERNEL void gather(const std::array<const Mask*, 27>& set,
                            uint64_t (&words)[3][3][kPlanes]) {
  for (size_t y = 0; y < 3; ++y)
    for (size_t z = 0; z < 3; ++z) {
      uint64_t* const to = words[y][z];
      to[0] = (*set[y * 3 + z])[7];
      for (size_t x = 0; x < 8; ++x) to[x + 1] = (*set[9 + y * 3 + z])[x];
      to[9] = (*set[18 + y * 3 + z])[0];
    }
}

/// Adds up along z, then y, then x.
VDB_MADF_KERNEL void addAround(const uint64_t (&words)[3][3][kPlanes], VoxelsAround& around) {
  uint64_t plane[4][kPlanes], across[kPlanes];  // digits of the sums over y and z
  for (size_t x = 0; x < kPlanes; ++x) {
    const uint64_t own = words[1][1][x];
    const uint64_t left = before(own, words[1][0][x]), right = behind(own, words[1][2][x]);
    const uint64_t sum = own ^ left ^ right, carry = majority(own, left, right);

    const uint64_t outer = outerRows(words[0][1][x], words[2][1][x]);
    const uint64_t outerLeft = before(outer, outerRows(words[0][0][x], words[2][0][x]));
    const uint64_t outerRight = behind(outer, outerRows(words[0][2][x], words[2][2][x]));
    const uint64_t outerSum = outer ^ outerLeft ^ outerRight;
    const uint64_t outerCarry = majority(outer, outerLeft, outerRight);

    const uint64_t lowSum = lowerRows(sum, outerSum), highSum = upperRows(sum, outerSum);
    const uint64_t lowCarry = lowerRows(carry, outerCarry);
    const uint64_t highCarry = upperRows(carry, outerCarry);
    const uint64_t ones = majority(sum, lowSum, highSum);
    const uint64_t twos = carry ^ lowCarry ^ highCarry;
    const uint64_t fours = majority(carry, lowCarry, highCarry);
    plane[0][x] = sum ^ lowSum ^ highSum;
    plane[1][x] = twos ^ ones;
    plane[2][x] = fours ^ (twos & ones);
    plane[3][x] = fours & twos & ones;
    across[x] = left | right | lowerRows(own, outer) | upperRows(own, outer);
  }
  for (size_t x = 0; x < 8; ++x) {
    uint64_t sum[4], carry[4];
    for (size_t i = 0; i < 4; ++i) {
      const uint64_t a = plane[i][x], b = plane[i][x + 1], c = plane[i][x + 2];
      sum[i] = a ^ b ^ c;
      carry[i] = majority(a, b, c);
    }
    const uint64_t four = sum[1] & carry[0], eight = majority(sum[2], carry[1], four);
    const uint64_t sixteen = majority(sum[3], carry[2], eight);
    around.count[0][x] = sum[0];
    around.count[1][x] = sum[1] ^ carry[0];
    around.count[2][x] = sum[2] ^ carry[1] ^ four;
    around.count[3][x] = sum[3] ^ carry[2] ^ eight;
    around.count[4][x] = carry[3] | sixteen;
    around.faces[x] = across[x + 1] | words[1][1][x] | words[1][1][x + 2];
  }
}

VDB_MADF_KERNEL void compare(const LeafCounts& a, const LeafCounts& b, Mask& greater) {
  for (size_t x = 0; x < 8; ++x) {
    uint64_t more = 0, same = ~uint64_t(0);
    for (size_t i = 5; i-- > 0;) {
      more |= same & a[i][x] & ~b[i][x];
      same &= ~(a[i][x] ^ b[i][x]);
    }
    greater[x] = more;
  }
}

VDB_MADF_KERNEL void assign(LeafCounts& a, const LeafCounts& b, const Mask& voxels) {
  for (size_t i = 0; i < 5; ++i)
    for (size_t x = 0; x < 8; ++x) a[i][x] = (a[i][x] & ~voxels[x]) | (b[i][x] & voxels[x]);
}

}  // namespace

VoxelsAround voxelsAround(const std::array<const Mask*, 27>& set) {
  return atBestLevel([&]() VDB_MADF_INLINE {
    uint64_t words[3][3][kPlanes];
    gather(set, words);
    VoxelsAround around;
    addAround(words, around);
    return around;
  });
}

Mask isGreater(const LeafCounts& a, const LeafCounts& b) {
  return atBestLevel([&]() VDB_MADF_INLINE {
    Mask greater;
    compare(a, b, greater);
    return greater;
  });
}

void assignCounts(LeafCounts& a, const LeafCounts& b, const Mask& voxels) {
  atBestLevel([&]() VDB_MADF_INLINE { assign(a, b, voxels); });
}

Mask areSurrounded(const VoxelsAround& around) {
  Mask all;
  for (size_t x = 0; x < 8; ++x)  // 27 = 16 + 8 + 2 + 1
    all[x] = around.count[0][x] & around.count[1][x] & around.count[3][x] & around.count[4][x];
  return all;
}

}  // namespace vdb_madf::detail
