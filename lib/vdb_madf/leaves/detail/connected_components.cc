// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/connected_components.h"

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_faces.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

using Pieces = std::vector<ConnectedComponents::Piece>;

void addPieces(const LeafIndex::Mask& mask, uint32_t label, Pieces& pieces) {
  if (mask == kFullMask) {
    pieces.push_back({mask, label, 0});
    return;
  }
  forEachPiece(mask, [&](const LeafIndex::Mask& piece) { pieces.push_back({piece, label, 0}); });
}

}  // namespace

ConnectedComponents::ConnectedComponents(const LeafIndex& index, Interrupter* interrupter) {
  find(index, nullptr, interrupter);
}

ConnectedComponents::ConnectedComponents(const LeafIndex& index, const LabelMasks& labels,
                                         Interrupter* interrupter) {
  find(index, &labels, interrupter);
}

void ConnectedComponents::find(const LeafIndex& index, const LabelMasks* labels,
                               Interrupter* interrupter) {
  findPieces(index, labels, interrupter);
  DisjointSets sets(pieces_.size());
  joinPieces(index, sets, interrupter);
  numberComponents(sets);
}

void ConnectedComponents::findPieces(const LeafIndex& index, const LabelMasks* labels,
                                     Interrupter* interrupter) {
  constexpr size_t kChunk = 1024;
  struct Chunk {
    Pieces pieces;
    std::vector<uint32_t> counts;  // per leaf
  };
  std::vector<Chunk> chunks((index.leafCount() + kChunk - 1) / kChunk);
  parallelForEach(chunks.size(), 1, interrupter, [&](size_t i) {
    Pieces& pieces = chunks[i].pieces;
    const size_t stop = std::min(index.leafCount(), (i + 1) * kChunk);
    for (size_t leaf = i * kChunk; leaf < stop; ++leaf) {
      const size_t before = pieces.size();
      if (labels)
        for (auto entry = labels->begin(leaf); entry != labels->end(leaf); ++entry)
          addPieces(entry->mask, entry->label, pieces);
      else
        addPieces(index.mask(leaf), 1, pieces);
      chunks[i].counts.push_back(uint32_t(pieces.size() - before));
    }
  });
  firstPiece_.reserve(index.leafCount() + 1);
  firstPiece_.push_back(0);
  for (const Chunk& chunk : chunks)
    for (const uint32_t pieces : chunk.counts) firstPiece_.push_back(firstPiece_.back() + pieces);
  pieces_.resize(firstPiece_.back());
  parallelForEach(chunks.size(), 1, interrupter, [&](size_t i) {
    std::copy(chunks[i].pieces.begin(), chunks[i].pieces.end(),
              pieces_.begin() + firstPiece_[i * kChunk]);
    chunks[i] = {};
  });
}

/// Pieces that meet in a face between leaves belong together, if their labels agree. First those
/// within parts of the leaves, which share no sets, in parallel; then those between two parts,
/// between two pairs of parts, and so on.
void ConnectedComponents::joinPieces(const LeafIndex& index, DisjointSets& sets,
                                     Interrupter* interrupter) const {
  constexpr size_t kParts = 32;
  const size_t leaves = index.leafCount(), part = leaves / kParts + 1;
  for (size_t width = part; width < 2 * kParts * part; width *= 2) {  // leaves of a group of parts
    const size_t before = width / 2;                                  // joined within already
    const auto join = [&](size_t group) {
      const size_t stop = std::min((group + 1) * width, leaves);
      for (size_t leaf = group * width; leaf < stop; ++leaf)
        for (size_t axis = 0; axis < 3; ++axis) {
          const uint32_t next = index.neighbors(leaf)[2 * axis + 1];
          if (next == LeafIndex::kNone || next / width != group) continue;
          if (width == part || next / before != leaf / before)
            joinFaces(uint32_t(leaf), next, axis, sets);
        }
    };
    parallelForEach((leaves + width - 1) / width, 1, interrupter,
                    [&](size_t group) { join(group); });
  }
}

/// The pieces on both sides of the face between a leaf and the next one along an axis. Pieces of a
/// leaf ascend by label.
void ConnectedComponents::joinFaces(uint32_t leaf, uint32_t next, size_t axis,
                                    DisjointSets& sets) const {
  struct Face {
    uint64_t places;
    uint32_t label, piece;
  };
  Face there[512];
  size_t count = 0;
  for (uint32_t i = firstPiece_[next]; i < firstPiece_[next + 1]; ++i)
    if (const uint64_t places = faceMask(pieces_[i].mask, int(axis), 0))
      there[count++] = {places, pieces_[i].label, i};
  size_t first = 0;
  for (uint32_t i = firstPiece_[leaf]; i < firstPiece_[leaf + 1]; ++i) {
    uint64_t places = faceMask(pieces_[i].mask, int(axis), 7);
    const uint32_t label = pieces_[i].label;
    while (first < count && there[first].label < label) ++first;
    for (size_t k = first; places && k < count && there[k].label == label; ++k) {
      if (places & there[k].places) sets.unite(i, there[k].piece);
      places &= ~there[k].places;
    }
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
