// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/object_components.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

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

using Pieces = std::vector<LeafIndex::Mask>;

/// The components of a mask by itself, in the order of their first voxels.
void addPieces(const LeafIndex::Mask& mask, Pieces& pieces) {
  LeafIndex::Mask rest = mask;
  for (size_t x = 0; x < 8; ++x) {
    while (rest[x]) {
      LeafIndex::Mask seed{};
      seed[x] = rest[x] & (~rest[x] + 1);
      const LeafIndex::Mask piece = flood(seed, rest);
      for (size_t i = 0; i < 8; ++i) rest[i] &= ~piece[i];
      pieces.push_back(piece);
    }
  }
}

constexpr uint32_t kNoPiece = ~0u;

/// Writes `piece` to the places (64, by the other two coordinates) of a face that its voxels touch:
/// the last face along an axis, or the first.
void markFace(const LeafIndex::Mask& mask, int axis, bool last, uint32_t piece, uint32_t* face) {
  if (axis == 0) {
    forEachBit(mask[last ? 7 : 0], [&](int bit) { face[bit] = piece; });
    return;
  }
  for (size_t x = 0; x < 8; ++x) {
    const uint64_t bits =
        axis == 1 ? mask[x] & (last ? kLastY : kFirstY) : mask[x] & (last ? kLastZ : kFirstZ);
    forEachBit(bits,
               [&](int bit) { face[x * 8 + size_t(axis == 1 ? bit & 7 : bit >> 3)] = piece; });
  }
}

}  // namespace

ObjectComponents::ObjectComponents(const LeafIndex& index, Interrupter* interrupter) {
  findPieces(index, interrupter);
  DisjointSets sets(pieces_.size());
  joinPieces(index, sets);
  numberComponents(sets);
}

void ObjectComponents::findPieces(const LeafIndex& index, Interrupter* interrupter) {
  constexpr size_t kChunk = 1024;
  struct Chunk {
    Pieces pieces;
    std::vector<uint32_t> counts;  // per leaf
  };
  std::vector<Chunk> chunks((index.leafCount() + kChunk - 1) / kChunk);
  parallelFor(chunks.size(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t stop = std::min(index.leafCount(), (i + 1) * kChunk);
      for (size_t leaf = i * kChunk; leaf < stop; ++leaf) {
        const size_t before = chunks[i].pieces.size();
        addPieces(index.mask(leaf), chunks[i].pieces);
        chunks[i].counts.push_back(uint32_t(chunks[i].pieces.size() - before));
      }
    }
  });
  firstPiece_.reserve(index.leafCount() + 1);
  firstPiece_.push_back(0);
  for (Chunk& chunk : chunks) {
    for (const uint32_t count : chunk.counts) firstPiece_.push_back(firstPiece_.back() + count);
    for (const LeafIndex::Mask& mask : chunk.pieces) pieces_.push_back({mask, 0});
    chunk = {};
  }
}

/// Pieces that meet in a face between leaves belong together.
void ObjectComponents::joinPieces(const LeafIndex& index, DisjointSets& sets) const {
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    for (int axis = 0; axis < 3; ++axis) {
      const uint32_t next = index.neighbors(leaf)[size_t(2 * axis + 1)];
      if (next != LeafIndex::kNone) joinFaces(uint32_t(leaf), next, axis, sets);
    }
  }
}

/// The pieces on both sides of the face between a leaf and the next one along an axis.
void ObjectComponents::joinFaces(uint32_t leaf, uint32_t next, int axis, DisjointSets& sets) const {
  uint32_t here[64], there[64];
  std::fill(here, here + 64, kNoPiece);
  std::fill(there, there + 64, kNoPiece);
  for (uint32_t i = firstPiece_[leaf]; i < firstPiece_[leaf + 1]; ++i)
    markFace(pieces_[i].mask, axis, true, i, here);
  for (uint32_t i = firstPiece_[next]; i < firstPiece_[next + 1]; ++i)
    markFace(pieces_[i].mask, axis, false, i, there);
  uint32_t lastHere = kNoPiece, lastThere = kNoPiece;
  for (int i = 0; i < 64; ++i) {
    if (here[i] == kNoPiece || there[i] == kNoPiece) continue;
    if (here[i] == lastHere && there[i] == lastThere) continue;
    sets.unite(lastHere = here[i], lastThere = there[i]);
  }
}

/// A root is its set's first piece: components are numbered in that order.
void ObjectComponents::numberComponents(DisjointSets& sets) {
  for (uint32_t i = 0; i < pieces_.size(); ++i) {
    const uint32_t root = sets.find(i);
    pieces_[i].component = root == i ? count_++ : pieces_[root].component;
  }
}

uint32_t ObjectComponents::componentOf(VoxelId id) const {
  const uint32_t leaf = leafOf(id);
  uint32_t piece = firstPiece_[leaf];
  while (piece + 1 < firstPiece_[leaf + 1] && !(pieces_[piece].mask[wordOf(id)] >> bitOf(id) & 1))
    ++piece;
  return pieces_[piece].component;
}

}  // namespace vdb_madf::detail
