// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_faces.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

// No branches on single voxels, as in leaf_values.cc.

/// Spreads the values of the 8 lowest bits of a mask.
VDB_MADF_KERNEL void spread(uint64_t bits, const uint32_t* values, uint32_t* dense) {
  for (int i = 0; i < 8; ++i, bits >>= 1) {
    dense[i] = *values & (0u - uint32_t(bits & 1));
    values += bits & 1;
  }
}

VDB_MADF_KERNEL uint32_t countBelow(uint64_t word, int bit) {
  return countBits(word & ((uint64_t(1) << bit) - 1));
}

/// Along y or z. `ofWord`: the leaf's values.
VDB_MADF_KERNEL void copyRows(const LeafIndex::Mask& mask, const uint32_t* ofWord, int axis,
                              int position, uint32_t* face) {
  for (size_t x = 0; x < 8; ++x, face += 8) {
    const uint64_t word = mask[x];
    if (axis == 1) {
      const int bit = position * 8;
      spread(word >> bit, ofWord + countBelow(word, bit), face);
    } else {
      for (int y = 0; y < 8; ++y) {
        const int bit = y * 8 + position;
        face[y] = ofWord[countBelow(word, bit)] & (0u - uint32_t(word >> bit & 1));
      }
    }
    ofWord += countBits(word);
  }
}

}  // namespace

void copyFace(const LeafIndex& index, const uint32_t* values, uint32_t leaf, int axis, int position,
              uint32_t* face) {
  if (leaf == LeafIndex::kNone) {
    std::fill_n(face, 64, 0u);
    return;
  }
  const LeafIndex::Mask& mask = index.mask(leaf);
  if (axis == 0) {
    const VoxelId first = voxelId(leaf, size_t(position), 0);
    expandWord(mask[size_t(position)], values + index.rank(first), face);
    return;
  }
  const uint32_t* const ofLeaf = values + index.firstRank(leaf);
  atBestLevel([&]() VDB_MADF_INLINE { copyRows(mask, ofLeaf, axis, position, face); });
}

uint64_t faceMask(const LeafIndex& index, uint32_t leaf, int axis, int position) {
  return leaf == LeafIndex::kNone ? 0 : faceMask(index.mask(leaf), axis, position);
}

uint64_t faceMask(const LeafIndex::Mask& mask, int axis, int position) {
  if (axis == 0) return mask[size_t(position)];
  uint64_t face = 0;
  for (size_t x = 0; x < 8; ++x) {
    const uint64_t row = axis == 1 ? mask[x] >> (position * 8) & 0xff
                                   : packBits(mask[x] >> position & 0x0101010101010101u);
    face |= row << (x * 8);
  }
  return face;
}

}  // namespace vdb_madf::detail
