// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Spreads the values of a leaf's object voxels, one after the other as a VoxelArray holds them,
/// over all of its 512 voxels; 0 outside the object.
void expandLeaf(const LeafIndex::Mask& mask, const uint32_t* values, uint32_t* dense);

/// Expands the 64 voxels of one x, a word of the mask, likewise.
void expandWord(uint64_t word, const uint32_t* values, uint32_t* dense);

/// The way back: the dense values of the object voxels, one after the other.
void packLeaf(const LeafIndex::Mask& mask, const uint32_t* dense, uint32_t* values);

/// The voxels of a leaf, dense as above, that have a value.
LeafIndex::Mask voxelsOf(const uint32_t* dense, uint32_t value);

/// f(value, voxels) for each value that some voxels of a leaf have, by its first one. `dense`: as
/// above.
template <typename F>
void forEachValue(LeafIndex::Mask voxels, const uint32_t* dense, const F& f) {
  for (size_t x = 0; x < 8; ++x)
    while (voxels[x]) {
      const uint32_t value = dense[x * 64 + size_t(__builtin_ctzll(voxels[x]))];
      const LeafIndex::Mask same = both(voxels, voxelsOf(dense, value));
      voxels = without(voxels, same);
      f(value, same);
    }
}

/// Are all values the first one?
bool allEqual(const uint32_t* values, size_t count);

inline void expandLeaf(const LeafIndex::Mask& mask, const int32_t* values, int32_t* dense) {
  expandLeaf(mask, reinterpret_cast<const uint32_t*>(values), reinterpret_cast<uint32_t*>(dense));
}
inline void packLeaf(const LeafIndex::Mask& mask, const int32_t* dense, int32_t* values) {
  packLeaf(mask, reinterpret_cast<const uint32_t*>(dense), reinterpret_cast<uint32_t*>(values));
}

}  // namespace vdb_madf::detail
