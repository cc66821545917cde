// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/label_block.h"

#include <algorithm>

#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/leaves/detail/leaf_values.h"

namespace vdb_madf::detail {

namespace {

/// The labels of the row of 8 voxels along z that begins at `offset`.
[[gnu::always_inline]] inline void copyRow(const LeafIndex& index,
                                           const VoxelArray<uint32_t>& labels, uint32_t leaf,
                                           uint32_t offset, uint32_t* row) {
  const uint32_t bits = uint32_t(index.mask(leaf)[offset >> 6] >> (offset & 63) & 0xff);
  if (bits == 0) return;
  const uint32_t* from = labels.data() + index.rank(VoxelId(leaf * 512 + offset));
  for (uint32_t z = 0; z < 8; ++z)
    if (bits >> z & 1) row[z] = *from++;
}

[[gnu::always_inline]] inline uint32_t labelAt(const LeafIndex& index,
                                               const VoxelArray<uint32_t>& labels, uint32_t leaf,
                                               uint32_t offset) {
  if (!(index.mask(leaf)[offset >> 6] >> (offset & 63) & 1)) return 0;
  return labels[index.rank(VoxelId(leaf * 512 + offset))];
}

}  // namespace

void LabelBlock::load(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                      const std::array<uint32_t, 27>& around) {
  std::fill_n(&label[0][0][0], 1000, 0u);
  uint32_t dense[512];
  const uint32_t center = around[13];
  expandLeaf(index.mask(center), labels.data() + index.firstRank(center), dense);
  for (size_t x = 0; x < 8; ++x)
    for (size_t y = 0; y < 8; ++y) std::copy_n(dense + x * 64 + y * 8, 8, &label[x + 1][y + 1][1]);
  // Along an axis the block takes the last voxel of the leaf before, all of this one, the first of
  // the next.
  for (uint32_t i = 0; i < 27; ++i) {
    const uint32_t leaf = around[i];
    if (i == 13 || leaf == LeafIndex::kNone) continue;
    const uint32_t side[3] = {i / 9, i / 3 % 3, i % 3};
    const auto first = [&](int axis) { return side[axis] == 0 ? 7u : 0u; };
    const auto last = [&](int axis) { return side[axis] == 2 ? 0u : 7u; };
    for (uint32_t x = first(0); x <= last(0); ++x)
      for (uint32_t y = first(1); y <= last(1); ++y) {
        const uint32_t offset = x * 64 + y * 8;
        uint32_t* row =
            label[side[0] == 1 ? x + 1 : side[0] / 2 * 9][side[1] == 1 ? y + 1 : side[1] / 2 * 9];
        if (side[2] == 1)
          copyRow(index, labels, leaf, offset, row + 1);
        else
          row[side[2] / 2 * 9] = labelAt(index, labels, leaf, offset + first(2));
      }
  }
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

uint32_t LabelBlock::majority(uint32_t offset) const {
  return atBestLevel([&]() VDB_MADF_INLINE { return majorityAt(label, offset); });
}

}  // namespace vdb_madf::detail
