// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/connected_components.h"

#include <algorithm>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

using Pieces = std::vector<ConnectedComponents::Piece>;

/// The voxels of a leaf that have a label.
VDB_MADF_KERNEL LeafIndex::Mask equalTo(uint32_t label, const uint32_t* dense) {
  uint8_t equal[512];
  for (size_t i = 0; i < 512; ++i) equal[i] = dense[i] == label;
  LeafIndex::Mask mask;
  for (size_t x = 0; x < 8; ++x) mask[x] = wordOfBytes(equal + x * 64);
  return mask;
}

void addPieces(const LeafIndex::Mask& mask, uint32_t label, Pieces& pieces) {
  if (mask == kFullMask) {
    pieces.push_back({mask, label, 0});
    return;
  }
  forEachPiece(mask, [&](const LeafIndex::Mask& piece) { pieces.push_back({piece, label, 0}); });
}

/// The pieces of a leaf, by label in the order of its first voxel. `values`: of the leaf's voxels.
void addLabelPieces(const LeafIndex::Mask& mask, size_t count, const uint32_t* values,
                    Pieces& pieces) {
  if (allEqual(values, count)) {
    if (values[0] != 0) addPieces(mask, values[0], pieces);
    return;
  }
  uint32_t dense[512];
  expandLeaf(mask, values, dense);
  LeafIndex::Mask rest = mask;
  for (size_t x = 0; x < 8; ++x)
    while (rest[x]) {
      const uint32_t label = dense[x * 64 + size_t(__builtin_ctzll(rest[x]))];
      LeafIndex::Mask same = atBestLevel([&]() VDB_MADF_INLINE { return equalTo(label, dense); });
      for (size_t i = 0; i < 8; ++i) {
        same[i] &= mask[i];
        rest[i] &= ~same[i];
      }
      if (label != 0) addPieces(same, label, pieces);
    }
}

constexpr uint32_t kNoPiece = ~0u;

/// Writes `piece` to the places (64, by the other two coordinates) of a face that its voxels touch:
/// the last face along an axis, or the first.
void markFace(const LeafIndex::Mask& mask, size_t axis, bool last, uint32_t piece, uint32_t* face) {
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

ConnectedComponents::ConnectedComponents(const LeafIndex& index, Interrupter* interrupter) {
  find(index, nullptr, interrupter);
}

ConnectedComponents::ConnectedComponents(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                         Interrupter* interrupter) {
  find(index, &labels, interrupter);
}

void ConnectedComponents::find(const LeafIndex& index, const VoxelArray<uint32_t>* labels,
                               Interrupter* interrupter) {
  findPieces(index, labels, interrupter);
  DisjointSets sets(pieces_.size());
  joinPieces(index, sets, interrupter);
  numberComponents(sets);
}

void ConnectedComponents::findPieces(const LeafIndex& index, const VoxelArray<uint32_t>* labels,
                                     Interrupter* interrupter) {
  constexpr size_t kChunk = 1024;
  struct Chunk {
    Pieces pieces;
    std::vector<uint32_t> counts;  // per leaf
  };
  std::vector<Chunk> chunks((index.leafCount() + kChunk - 1) / kChunk);
  parallelFor(chunks.size(), 1, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Pieces& pieces = chunks[i].pieces;
      const size_t stop = std::min(index.leafCount(), (i + 1) * kChunk);
      for (size_t leaf = i * kChunk; leaf < stop; ++leaf) {
        const size_t before = pieces.size();
        if (labels)
          addLabelPieces(index.mask(leaf), index.leafVoxels(leaf),
                         labels->data() + index.firstRank(leaf), pieces);
        else
          addPieces(index.mask(leaf), 1, pieces);
        chunks[i].counts.push_back(uint32_t(pieces.size() - before));
      }
    }
  });
  size_t count = 0;
  for (const Chunk& chunk : chunks) count += chunk.pieces.size();
  pieces_.reserve(count);
  firstPiece_.reserve(index.leafCount() + 1);
  firstPiece_.push_back(0);
  for (Chunk& chunk : chunks) {
    for (const uint32_t pieces : chunk.counts) firstPiece_.push_back(firstPiece_.back() + pieces);
    pieces_.insert(pieces_.end(), chunk.pieces.begin(), chunk.pieces.end());
    chunk = {};
  }
}

/// Pieces that meet in a face between leaves belong together, if their labels agree. First those within
/// parts of the leaves, which share no sets, in parallel; then those between parts.
void ConnectedComponents::joinPieces(const LeafIndex& index, DisjointSets& sets,
                                     Interrupter* interrupter) const {
  constexpr size_t kParts = 32;
  const size_t leaves = index.leafCount(), part = leaves / kParts + 1;
  const auto join = [&](size_t begin, size_t end, bool within) {
    for (size_t leaf = begin; leaf < end; ++leaf)
      for (size_t axis = 0; axis < 3; ++axis) {
        const uint32_t next = index.neighbors(leaf)[2 * axis + 1];
        if (next != LeafIndex::kNone && (next / part == leaf / part) == within)
          joinFaces(uint32_t(leaf), next, axis, sets);
      }
  };
  parallelFor(kParts, 1, interrupter, [&](size_t begin, size_t end) {
    join(std::min(begin * part, leaves), std::min(end * part, leaves), true);
  });
  join(0, leaves, false);
}

/// The pieces on both sides of the face between a leaf and the next one along an axis.
void ConnectedComponents::joinFaces(uint32_t leaf, uint32_t next, size_t axis,
                                    DisjointSets& sets) const {
  if (end(leaf) - begin(leaf) == 1 && end(next) - begin(next) == 1) {  // mostly
    const Piece &a = *begin(leaf), &b = *begin(next);
    if (a.label == b.label && touchNext(a.mask, b.mask, axis))
      sets.unite(firstPiece_[leaf], firstPiece_[next]);
    return;
  }
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
    lastHere = here[i];
    lastThere = there[i];
    if (pieces_[lastHere].label == pieces_[lastThere].label) sets.unite(lastHere, lastThere);
  }
}

/// A root is its set's first piece: components are numbered in that order.
void ConnectedComponents::numberComponents(DisjointSets& sets) {
  for (uint32_t i = 0; i < pieces_.size(); ++i) {
    const uint32_t root = sets.find(i);
    pieces_[i].component = root == i ? count_++ : pieces_[root].component;
  }
}

uint32_t ConnectedComponents::componentOf(VoxelId id) const {
  const uint32_t leaf = leafOf(id);
  const Piece* piece = begin(leaf);
  while (piece + 1 != end(leaf) && !holds(piece->mask, offsetOf(id))) ++piece;
  return piece->component;
}

}  // namespace vdb_madf::detail
