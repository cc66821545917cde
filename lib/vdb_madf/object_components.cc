// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/object_components.h"

#include <algorithm>

#include "vdb_madf/detail/disjoint_sets.h"

namespace vdb_madf {

namespace {

constexpr uint64_t kFirstZ = 0x0101010101010101ull;  // bits y*8 + z with z = 0
constexpr uint64_t kLastZ = kFirstZ << 7;
constexpr uint64_t kFirstY = 0xffull;
constexpr uint64_t kLastY = kFirstY << 56;

/// Grows `seed` to the component of `mask` that holds it.
LeafIndex::Mask flood(LeafIndex::Mask seed, const LeafIndex::Mask& mask) {
  for (bool grown = true; grown;) {
    grown = false;
    for (int x = 0; x < 8; ++x) {
      const uint64_t w = seed[x];
      uint64_t next = w | (w & ~kLastZ) << 1 | (w & ~kFirstZ) >> 1 | w << 8 | w >> 8;
      if (x > 0) next |= seed[x - 1];
      if (x < 7) next |= seed[x + 1];
      next &= mask[x];
      if (next != w) {
        seed[x] = next;
        grown = true;
      }
    }
  }
  return seed;
}

/// Do a piece and one of the next leaf along an axis touch through the face between them?
bool touch(const LeafIndex::Mask& a, const LeafIndex::Mask& b, int axis) {
  if (axis == 0) return a[7] & b[0];
  for (int x = 0; x < 8; ++x) {
    if (axis == 1 && ((a[x] & kLastY) >> 56 & b[x])) return true;
    if (axis == 2 && ((a[x] & kLastZ) >> 7 & b[x])) return true;
  }
  return false;
}

}  // namespace

ObjectComponents::ObjectComponents(const LeafIndex& index) {
  firstPiece_.reserve(index.leafCount() + 1);
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    firstPiece_.push_back(uint32_t(pieces_.size()));
    LeafIndex::Mask rest = index.mask(leaf);
    for (int x = 0; x < 8; ++x) {
      while (rest[x]) {
        LeafIndex::Mask seed{};
        seed[x] = rest[x] & (~rest[x] + 1);
        const LeafIndex::Mask piece = flood(seed, rest);
        for (int i = 0; i < 8; ++i) rest[i] &= ~piece[i];
        pieces_.push_back({piece, 0});
      }
    }
  }
  firstPiece_.push_back(uint32_t(pieces_.size()));

  detail::DisjointSets sets(pieces_.size());
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      const uint32_t next = index.neighbors(leaf)[2 * axis + 1];
      if (next == LeafIndex::kNone) continue;
      for (uint32_t i = firstPiece_[leaf]; i < firstPiece_[leaf + 1]; ++i)
        for (uint32_t j = firstPiece_[next]; j < firstPiece_[next + 1]; ++j)
          if (touch(pieces_[i].mask, pieces_[j].mask, axis)) sets.unite(i, j);
    }
  }
  // A root is its set's first piece: number components in that order.
  for (uint32_t i = 0; i < pieces_.size(); ++i) {
    const uint32_t root = sets.find(i);
    pieces_[i].component = root == i ? count_++ : pieces_[root].component;
  }
}

uint32_t ObjectComponents::of(VoxelId id) const {
  const uint32_t leaf = id >> 9;
  uint32_t piece = firstPiece_[leaf];
  while (piece + 1 < firstPiece_[leaf + 1] && !(pieces_[piece].mask[id >> 6 & 7] >> (id & 63) & 1))
    ++piece;
  return pieces_[piece].component;
}

}  // namespace vdb_madf
