// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_pieces.h"

#include <algorithm>
#include <array>
#include <utility>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/slabs/cuts/face_voxels.h"

namespace vdb_madf::detail {

std::vector<FacePiece> facePieces(const LeafIndex& index, const ConnectedComponents& components,
                                  const Cut& cut) {
  std::vector<FacePiece> face;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != (cut.layer() & ~7)) continue;
    std::array<const ConnectedComponents::Piece*, 64> pieceOf;
    uint64_t any = 0;
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
      const uint64_t rows = layersAlongZ(piece->mask)[cut.isUpper ? 7 : 0];
      any |= rows;
      forEachBit(rows, [&](int row) { pieceOf[size_t(row)] = piece; });
    }
    const Coord& origin = index.origin(leaf);
    forEachBit(any, [&](int row) {
      const ConnectedComponents::Piece& piece = *pieceOf[size_t(row)];
      face.push_back(
          {origin.x() + (row >> 3), origin.y() + (row & 7), piece.component, piece.label});
    });
  }
  return face;
}

std::vector<PieceJoin> pieceJoins(const std::vector<FacePiece>& below,
                                  const std::vector<FacePiece>& above) {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  forEachFacing(below, above, [&](const FacePiece& p, const FacePiece& q) {
    if (p.label == q.label) pairs.emplace_back(p.piece, q.piece);
  });
  sortUnique(pairs);
  std::vector<PieceJoin> joins;
  for (const auto& [p, q] : pairs) joins.push_back({p, q});
  return joins;
}

void PieceUnion::add(size_t pieces, const std::vector<PieceJoin>& joins) {
  const uint32_t first = first_.back(), firstBelow = first_.size() > 1 ? first_.end()[-2] : 0;
  for (size_t i = 0; i < pieces; ++i) sets_.add();
  first_.push_back(first + uint32_t(pieces));
  for (const PieceJoin& join : joins) {
    const uint32_t a = sets_.find(firstBelow + join.below), b = sets_.find(first + join.above);
    joins_ += a != b;
    sets_.unite(a, b);
  }
}

std::vector<char> piecesWithAnchor(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                   const ConnectedComponents& components, const Anchors& anchors) {
  std::vector<char> held(components.count(), 0);
  for (uint32_t g = 0; g < anchors.size(); ++g) {
    if (!index.boundingBox().isInside(anchors[g])) continue;
    const auto id = index.findVoxel(anchors[g]);
    if (id && labels[index.rank(*id)] == g + 1) held[components.componentOf(*id)] = 1;
  }
  return held;
}

std::vector<LeafPiece> piecesWithoutAnchor(const LeafIndex& index,
                                           const ConnectedComponents& components,
                                           const std::vector<char>& hasAnchor) {
  std::vector<LeafPiece> pieces;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      if (!hasAnchor[piece->component]) pieces.push_back({leaf, *piece});
  return pieces;
}

std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                    const std::vector<LeafPiece>& loose, int begin, int end,
                                    const BeyondPieces& below, const BeyondPieces& above) {
  const auto beyond = [](const BeyondPieces& pieces, const Coord& p) {
    const FacePiece* const voxel = findOnFace(pieces.face, p);
    return voxel && pieces.isHeld[voxel->piece] ? voxel->label : 0;
  };
  const auto isLoose = [&](VoxelId id) {
    const auto before = [](const LeafPiece& piece, uint32_t leaf) { return piece.leaf < leaf; };
    auto piece = std::lower_bound(loose.begin(), loose.end(), leafOf(id), before);
    for (; piece != loose.end() && piece->leaf == leafOf(id); ++piece)
      if (holds(piece->piece.mask, offsetOf(id))) return true;
    return false;
  };
  std::vector<LooseVoxel> voxels;
  const auto add = [&](VoxelId id, uint32_t label) {
    LooseVoxel voxel{index.coord(id), label, {}};
    forEachNeighbor(index, id, [&](VoxelId q, int axis, int step) {
      if (isObject(index, q) && !isLoose(q))
        voxel.around[size_t(2 * axis + (step > 0))] = labels[index.rank(q)];
    });
    const Coord& p = voxel.position;
    if (p.z() == begin) voxel.around[4] = beyond(below, p);
    if (p.z() == end - 1) voxel.around[5] = beyond(above, p);
    voxels.push_back(voxel);
  };
  for (const auto& [leaf, piece] : loose)
    for (uint32_t x = 0; x < 8; ++x) {
      const VoxelId first = voxelId(leaf, x, 0);
      const uint32_t label = piece.label;
      forEachBit(piece.mask[x], [&](int bit) { add(first + uint32_t(bit), label); });
    }
  return voxels;
}

void refillAll(std::vector<LooseVoxel>& loose, Interrupter* interrupter) {
  std::sort(loose.begin(), loose.end(),
            [](const LooseVoxel& a, const LooseVoxel& b) { return a.position < b.position; });
  const auto find = [&](const Coord& p) {
    const auto less = [](const LooseVoxel& voxel, const Coord& q) { return voxel.position < q; };
    const auto found = std::lower_bound(loose.begin(), loose.end(), p, less);
    return found != loose.end() && found->position == p ? &*found : nullptr;
  };
  const auto around = [&](uint32_t i) { return loose[i].around; };
  const auto forEachNext = [&](uint32_t i, const auto& f) {
    for (size_t side = 0; side < 6; ++side) {
      Coord q = loose[i].position;
      q[int(side / 2)] += side % 2 ? 1 : -1;
      if (LooseVoxel* const next = find(q)) f(*next, side);
    }
  };
  const auto give = [&](uint32_t i, uint32_t label) {
    loose[i].label = label;
    forEachNext(i, [&](LooseVoxel& next, size_t side) { next.around[side ^ 1] = label; });
  };
  const auto beside = [&](uint32_t i, const auto& f) {
    forEachNext(i, [&](const LooseVoxel& next, size_t) { f(uint32_t(&next - loose.data())); });
  };
  refill(loose.size(), around, give, beside, interrupter);
}

}  // namespace vdb_madf::detail
