// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/detail/slab_pieces.h"

#include <algorithm>
#include <array>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/slabs/detail/face_voxels.h"

namespace vdb_madf::detail {

namespace {

using FaceVoxel = SlabPieces::FaceVoxel;

std::vector<FaceVoxel> facePieces(const LeafIndex& index, const ConnectedComponents& components,
                                  int leafZ, uint32_t layer) {
  std::vector<FaceVoxel> face;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    if (index.origin(leaf).z() != leafZ) continue;
    std::array<uint32_t, 64> pieceOf;
    uint64_t any = 0;
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
      const uint64_t rows = layersAlongZ(piece->mask)[layer];
      any |= rows;
      forEachBit(rows, [&](int row) { pieceOf[size_t(row)] = piece->component; });
    }
    const Coord& origin = index.origin(leaf);
    forEachBit(any, [&](int row) {
      face.push_back({origin.x() + (row >> 3), origin.y() + (row & 7), pieceOf[size_t(row)]});
    });
  }
  return face;
}

}  // namespace

SlabPieces::SlabPieces(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                       const ConnectedComponents& components, const Anchors& anchors, int begin,
                       int end)
    : label(components.count()),
      held(components.count(), 0),
      lowest(facePieces(index, components, begin, 0)),
      highest(facePieces(index, components, end - 8, 7)) {
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      label[piece->component] = piece->label;
  for (uint32_t g = 0; g < anchors.size(); ++g) {
    if (anchors[g].z() < begin || anchors[g].z() >= end) continue;
    const auto id = index.findVoxel(anchors[g]);
    if (id && labels[index.rank(*id)] == g + 1) held[components.componentOf(*id)] = 1;
  }
}

void SlabPieces::writeTo(ByteWriter& bytes) const {
  bytes.add(label);
  bytes.add(held);
  bytes.add(lowest);
  bytes.add(highest);
}

SlabPieces SlabPieces::readFrom(ByteReader& bytes) {
  SlabPieces result;
  result.label = bytes.vector<uint32_t>();
  result.held = bytes.vector<char>();
  result.lowest = bytes.vector<FaceVoxel>();
  result.highest = bytes.vector<FaceVoxel>();
  return result;
}

void PieceUnion::add(const SlabPieces& pieces, const SlabPieces* before) {
  const uint32_t first = first_.back();
  for (size_t i = 0; i < pieces.label.size(); ++i) sets_.add();
  held_.insert(held_.end(), pieces.held.begin(), pieces.held.end());
  first_.push_back(first + uint32_t(pieces.label.size()));
  if (!before) return;
  const uint32_t firstBefore = first_[first_.size() - 3];
  forEachFacing(before->highest, pieces.lowest, [&](const FaceVoxel& p, const FaceVoxel& q) {
    if (before->label[p.piece] != pieces.label[q.piece]) return;
    const uint32_t a = sets_.find(firstBefore + p.piece), b = sets_.find(first + q.piece);
    joins_ += a != b;
    sets_.unite(a, b);
  });
}

bool PieceUnion::isHeld(size_t slab, uint32_t piece) {
  if (!joined_)
    for (uint32_t i = 0; i < held_.size(); ++i)
      if (held_[i]) held_[sets_.find(i)] = 1;
  joined_ = true;
  return held_[sets_.find(first_[slab] + piece)] != 0;
}

std::vector<LooseVoxel> looseVoxels(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                    const ConnectedComponents& components, size_t slab, int begin,
                                    int end, const SlabPieces* below, const SlabPieces* above,
                                    PieceUnion& pieces) {
  std::vector<char> isLoose(components.count());
  for (uint32_t piece = 0; piece < components.count(); ++piece)
    isLoose[piece] = !pieces.isHeld(slab, piece);
  const auto beyond = [&](const SlabPieces* other, size_t number, bool highest, const Coord& p) {
    if (!other) return uint32_t(0);
    const FaceVoxel* const voxel = findOnFace(highest ? other->highest : other->lowest, p);
    return voxel && pieces.isHeld(number, voxel->piece) ? other->label[voxel->piece] : 0;
  };
  std::vector<LooseVoxel> loose;
  const auto add = [&](VoxelId id, uint32_t label) {
    LooseVoxel voxel{index.coord(id), label, {}};
    forEachNeighbor(index, id, [&](VoxelId q, int axis, int step) {
      if (!isObject(index, q) || labels[index.rank(q)] == 0) return;
      if (!isLoose[components.componentOf(q)])
        voxel.around[2 * axis + (step > 0)] = labels[index.rank(q)];
    });
    const Coord& p = voxel.position;
    if (p.z() == begin) voxel.around[4] = beyond(below, slab - 1, true, p);
    if (p.z() == end - 1) voxel.around[5] = beyond(above, slab + 1, false, p);
    loose.push_back(voxel);
  };
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece) {
      if (!isLoose[piece->component]) continue;
      for (uint32_t x = 0; x < 8; ++x)
        forEachBit(piece->mask[x],
                   [&](int bit) { add(leaf * 512 + x * 64 + uint32_t(bit), piece->label); });
    }
  return loose;
}

void refill(std::vector<LooseVoxel>& loose) {
  std::sort(loose.begin(), loose.end(),
            [](const LooseVoxel& a, const LooseVoxel& b) { return a.position < b.position; });
  const auto find = [&](const Coord& p) {
    const auto less = [](const LooseVoxel& voxel, const Coord& q) { return voxel.position < q; };
    const auto found = std::lower_bound(loose.begin(), loose.end(), p, less);
    return found != loose.end() && found->position == p ? &*found : nullptr;
  };
  std::vector<size_t> rest(loose.size());
  for (size_t i = 0; i < rest.size(); ++i) rest[i] = i;
  std::vector<uint32_t> found;
  for (bool changed = true; changed && !rest.empty();) {
    found.clear();
    for (const size_t i : rest) found.push_back(mostFrequent(loose[i].around));
    size_t left = 0;
    for (size_t i = 0; i < rest.size(); ++i) {
      LooseVoxel& voxel = loose[rest[i]];
      if (found[i] == 0) {
        rest[left++] = rest[i];
        continue;
      }
      voxel.label = found[i];
      for (int side = 0; side < 6; ++side) {
        Coord q = voxel.position;
        q[side / 2] += side % 2 ? 1 : -1;
        if (LooseVoxel* const next = find(q)) next->around[side ^ 1] = found[i];
      }
    }
    changed = left < rest.size();
    rest.resize(left);
  }
}

}  // namespace vdb_madf::detail
