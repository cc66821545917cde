// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstring>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/grids/domain.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/leaves/leaf_index.h"

// Sets of voxels of one leaf, 64 at a time.

namespace vdb_madf::detail {

/// Bits y*8 + z of a mask word with y = 0, with y = 7.
constexpr uint64_t kFirstY = 0xffull, kLastY = kFirstY << 56;

/// All voxels of a leaf.
constexpr LeafIndex::Mask kFullMask{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};

/// The active voxels of a leaf node.
inline LeafIndex::Mask maskOf(const MaskTree::LeafNodeType& leaf) {
  LeafIndex::Mask mask;
  for (openvdb::Index x = 0; x < 8; ++x) mask[x] = leaf.getValueMask().getWord<uint64_t>(x);
  return mask;
}

inline bool anyVoxel(const LeafIndex::Mask& mask) {
  uint64_t any = 0;
  for (const uint64_t word : mask) any |= word;
  return any != 0;
}

inline uint32_t countVoxels(const LeafIndex::Mask& mask) {
  return uint32_t(countBitsIn(mask));
}

inline bool meet(const LeafIndex::Mask& a, const LeafIndex::Mask& b) {
  uint64_t any = 0;
  for (size_t x = 0; x < 8; ++x) any |= a[x] & b[x];
  return any != 0;
}

inline bool holds(const LeafIndex::Mask& mask, uint32_t offset) {
  return mask[offset >> 6] >> (offset & 63) & 1;
}

/// The eight layers of a leaf along z: bit x*8 + y of word z is voxel (x, y, z).
inline std::array<uint64_t, 8> layersAlongZ(const LeafIndex::Mask& mask) {
  std::array<uint64_t, 8> layers{};
  for (size_t z = 0; z < 8; ++z)
    for (size_t x = 0; x < 8; ++x) layers[z] |= uint64_t(packBits(mask[x] >> z & kFirstZ)) << 8 * x;
  return layers;
}

/// 64 bytes of 0 or 1, those of the voxels of one x, to a word of a mask. For kernels (simd.h),
/// too.
[[gnu::always_inline]] inline uint64_t wordOfBytes(const uint8_t* bytes) {
  uint64_t word = 0;
  for (size_t y = 0; y < 8; ++y) {
    uint64_t row;
    std::memcpy(&row, bytes + 8 * y, sizeof row);
    word |= uint64_t(packBits(row)) << 8 * y;
  }
  return word;
}

/// Grows `seed` to the 6-connected component of `mask` that holds it.
LeafIndex::Mask flood(LeafIndex::Mask seed, const LeafIndex::Mask& mask);

/// The voxels of the leaf on a side (in the order of LeafIndex::Neighbors) that are neighbors of
/// voxels of `mask`.
LeafIndex::Mask across(const LeafIndex::Mask& mask, size_t side);

/// The side that faces a side.
constexpr size_t opposite(size_t side) {
  return side ^ 1;
}

/// The voxels of `mask` and their neighbors within the leaf.
LeafIndex::Mask dilate(const LeafIndex::Mask& mask);

/// The voxels of a mask with the 26 around them in it too, where those beyond the leaf all are
/// (beyond is ~0) or all are not (0).
LeafIndex::Mask erode(const LeafIndex::Mask& mask, uint64_t beyond);

/// About how many voxels are in structures one or two voxels thick, or between small holes: those
/// that have no face in common with a voxel all of whose six neighbors are in `mask`; or, if that
/// is more, 0.55 of those without one all of whose 18 are, and of 26 around them without one all of
/// whose 26 are (as many are critical points in smoothed noise). Told by the voxels that are not at
/// faces of the leaf, for all in proportion.
int64_t countThin(const LeafIndex::Mask& mask);

/// About how many 6-connected pieces of the object have a place in the leaf as a whole, so that
/// they are grains by themselves: those that are not at its faces, in proportion.
int64_t countSpecks(const LeafIndex::Mask& mask);

/// The voxels of the leaf at `origin` that lie in a box.
LeafIndex::Mask inBox(const Coord& origin, const CoordBBox& box);

/// The voxels of the leaf at `origin` that lie in a domain.
LeafIndex::Mask insideMask(const Domain& domain, const Coord& origin);

/// The voxels of the leaf at `origin` that lie in a domain together with their six neighbors.
LeafIndex::Mask innerMask(const Domain& domain, const Coord& origin);

/// The origin of the leaf on a side.
inline Coord beside(Coord origin, size_t side) {
  origin[side / 2] += side % 2 ? 8 : -8;
  return origin;
}

inline LeafIndex::Mask without(LeafIndex::Mask mask, const LeafIndex::Mask& other) {
  for (size_t x = 0; x < 8; ++x) mask[x] &= ~other[x];
  return mask;
}
inline LeafIndex::Mask either(LeafIndex::Mask mask, const LeafIndex::Mask& other) {
  for (size_t x = 0; x < 8; ++x) mask[x] |= other[x];
  return mask;
}
inline LeafIndex::Mask both(LeafIndex::Mask mask, const LeafIndex::Mask& other) {
  for (size_t x = 0; x < 8; ++x) mask[x] &= other[x];
  return mask;
}

/// f(piece) for the 6-connected components of a mask, in the order of their first voxels.
template <typename F>
void forEachPiece(LeafIndex::Mask rest, const F& f) {
  for (size_t x = 0; x < 8; ++x) {
    while (rest[x]) {
      LeafIndex::Mask seed{};
      seed[x] = rest[x] & (~rest[x] + 1);
      const LeafIndex::Mask piece = flood(seed, rest);
      for (size_t i = 0; i < 8; ++i) rest[i] &= ~piece[i];
      f(piece);
    }
  }
}

}  // namespace vdb_madf::detail
