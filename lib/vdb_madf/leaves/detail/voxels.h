// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Voxels along each side of a leaf.
constexpr int kLeafSide = 8;
/// Leaves per task of a loop over voxels: some tens of microseconds.
constexpr size_t kLeafGrain = 64;
/// Leaves per task of a loop that does little in each leaf.
constexpr size_t kLightLeafGrain = 256;

/// Bits y*8 + z of a mask word with z = 0, with z = 7.
constexpr uint64_t kFirstZ = 0x0101010101010101ull, kLastZ = kFirstZ << 7;

/// f(id, rank) for the object voxels of leaves [begin, end), ascending.
template <typename F>
void forEachVoxel(const LeafIndex& index, size_t begin, size_t end, const F& f) {
  size_t rank = index.firstRank(begin);
  for (size_t leaf = begin; leaf < end; ++leaf) {
    const LeafIndex::Mask& mask = index.mask(leaf);
    for (size_t x = 0; x < 8; ++x)
      forEachBit(mask[x], [&](int bit) { f(voxelId(leaf, x, size_t(bit)), rank++); });
  }
}

/// f(id, axis, step) for the 6-neighbors of a voxel, `step` (-1, 1) along `axis`, that lie in
/// leaves of the index (whether or not they are object voxels).
template <typename F>
void forEachNeighbor(const LeafIndex& index, VoxelId id, const F& f) {
  const LeafIndex::Neighbors& leaves = index.neighbors(leafOf(id));
  const uint32_t offset = offsetOf(id), leafBase = id - offset;
  constexpr int kShift[3] = {6, 3, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t step = 1u << kShift[axis], t = offset >> kShift[axis] & 7;
    if (t > 0)
      f(leafBase + offset - step, axis, -1);
    else if (leaves[2 * axis] != LeafIndex::kNone)
      f(voxelId(leaves[2 * axis], offset + 7 * step), axis, -1);
    if (t < 7)
      f(leafBase + offset + step, axis, 1);
    else if (leaves[2 * axis + 1] != LeafIndex::kNone)
      f(voxelId(leaves[2 * axis + 1], offset - 7 * step), axis, 1);
  }
}

inline bool isObject(const LeafIndex& index, VoxelId id) {
  return index.mask(leafOf(id))[wordOf(id)] >> bitOf(id) & 1;
}

}  // namespace vdb_madf::detail
