// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/label_block.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_faces.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

VDB_MADF_KERNEL uint32_t labelAt(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                                 uint32_t leaf, uint32_t offset) {
  if (!(index.mask(leaf)[offset >> 6] >> (offset & 63) & 1)) return 0;
  return labels[index.rank(VoxelId(leaf * 512 + offset))];
}

/// The layer of voxels around the leaf, but for that of its faces: where two or three coordinates lie
/// beyond it.
VDB_MADF_KERNEL void copyEdges(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                               const std::array<uint32_t, 27>& around,
                               uint32_t (&block)[10][10][10]) {
  for (uint32_t i = 0; i < 27; ++i) {
    const uint32_t leaf = around[i];
    const uint32_t side[3] = {i / 9, i / 3 % 3, i % 3};
    if ((side[0] == 1) + (side[1] == 1) + (side[2] == 1) > 1) continue;
    // Along an axis the block takes the last voxel of the leaf before, all of this one, the first of
    // the next.
    const auto first = [&](int axis) { return side[axis] == 0 ? 7u : 0u; };
    const auto last = [&](int axis) { return side[axis] == 2 ? 0u : 7u; };
    const auto place = [&](int axis, uint32_t t) {
      return side[axis] == 1 ? t + 1 : side[axis] / 2 * 9;
    };
    for (uint32_t x = first(0); x <= last(0); ++x)
      for (uint32_t y = first(1); y <= last(1); ++y)
        for (uint32_t z = first(2); z <= last(2); ++z)
          block[place(0, x)][place(1, y)][place(2, z)] =
              leaf == LeafIndex::kNone ? 0 : labelAt(index, labels, leaf, x * 64 + y * 8 + z);
  }
}

}  // namespace

void LabelBlock::loadFaces(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                           const std::array<uint32_t, 27>& around) {
  uint32_t dense[512];
  const uint32_t center = around[13];
  expandLeaf(index.mask(center), labels.data() + index.firstRank(center), dense);
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) std::copy_n(dense + x * 64 + y * 8, 8, &label[x + 1][y + 1][1]);
  for (size_t end : {0, 1}) {
    const int position = end == 0 ? 7 : 0;  // in the leaf beside
    const size_t at = end * 9;
    uint32_t face[8][8];
    copyFace(index, labels.data(), around[13 - 9 + end * 18], 0, position, face[0]);
    for (size_t y = 0; y < 8; ++y) std::copy_n(face[y], 8, &label[at][y + 1][1]);
    copyFace(index, labels.data(), around[13 - 3 + end * 6], 1, position, face[0]);
    for (size_t x = 0; x < 8; ++x) std::copy_n(face[x], 8, &label[x + 1][at][1]);
    copyFace(index, labels.data(), around[13 - 1 + end * 2], 2, position, face[0]);
    for (size_t x = 0; x < 8; ++x)
      for (size_t y = 0; y < 8; ++y) label[x + 1][y + 1][at] = face[x][y];
  }
}

void LabelBlock::loadEdges(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                           const std::array<uint32_t, 27>& around) {
  atBestLevel([&]() VDB_MADF_INLINE { copyEdges(index, labels, around, label); });
}

namespace {

VDB_MADF_KERNEL LeafIndex::Mask interfacesOf(const uint32_t label[10][10][10]) {
  LeafIndex::Mask mask{};
  for (size_t x = 1; x < 9; ++x)
    for (size_t y = 1; y < 9; ++y) {
      uint32_t other[8], any = 0;
      for (size_t z = 1; z < 9; ++z) {
        const uint32_t own = label[x][y][z];
        const auto differs = [own](uint32_t l) { return uint32_t(l != 0) & uint32_t(l != own); };
        other[z - 1] = (differs(label[x - 1][y][z]) | differs(label[x + 1][y][z]) |
                        differs(label[x][y - 1][z]) | differs(label[x][y + 1][z]) |
                        differs(label[x][y][z - 1]) | differs(label[x][y][z + 1])) &
                       uint32_t(own != 0);
        any |= other[z - 1];
      }
      if (!any) continue;
      for (size_t z = 0; z < 8; ++z) mask[x - 1] |= uint64_t(other[z]) << ((y - 1) * 8 + z);
    }
  return mask;
}

/// The label of most voxels around one and itself: its own or one across a face, see tidy.h.
VDB_MADF_KERNEL uint32_t majorityAt(const uint32_t label[10][10][10], uint32_t offset) {
  const size_t x = (offset >> 6) + 1, y = (offset >> 3 & 7) + 1, z = (offset & 7) + 1;
  uint32_t cube[32] = {};
  for (size_t i = 0; i < 9; ++i)
    std::copy_n(&label[x + i / 3 - 1][y + i % 3 - 1][z - 1], 3, cube + i * 3);
  const auto count = [&cube](uint32_t l) {
    uint32_t voxels = 0;
    for (const uint32_t c : cube) voxels += c == l;
    return voxels;
  };
  const uint32_t own = label[x][y][z];
  uint32_t best = own, most = count(own);
  if (most > 13) return own;
  for (const uint32_t other : {label[x - 1][y][z], label[x + 1][y][z], label[x][y - 1][z],
                               label[x][y + 1][z], label[x][y][z - 1], label[x][y][z + 1]}) {
    if (other == 0 || other == own || other == best) continue;
    const uint32_t voxels = count(other);
    if (voxels > most || (voxels == most && best != own && other < best)) {
      best = other;
      most = voxels;
    }
  }
  return best;
}

}  // namespace

LeafIndex::Mask LabelBlock::interfaces() const {
  return atBestLevel([&]() VDB_MADF_INLINE { return interfacesOf(label); });
}

size_t LabelBlock::smooth(const LeafIndex::Mask& voxels, Change* changes) const {
  return atBestLevel([&]() VDB_MADF_INLINE {
    size_t count = 0;
    for (uint32_t x = 0; x < 8; ++x)
      for (uint64_t bits = voxels[x]; bits; bits &= bits - 1) {
        const uint32_t offset = x * 64 + uint32_t(__builtin_ctzll(bits));
        changes[count] = {offset, majorityAt(label, offset)};
        count += changes[count].label != at(offset);
      }
    return count;
  });
}

}  // namespace vdb_madf::detail
