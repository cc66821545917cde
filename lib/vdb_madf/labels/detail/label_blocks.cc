// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/label_blocks.h"

#include <algorithm>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/label_sizes.h"

namespace vdb_madf::detail {

namespace {

using LabelLeaf = Int32Tree::LeafNodeType;

/// Where a neighbor's voxels go along one axis: [from, from + count) of it to `to` of the block.
struct Span {
  int from, count, to;
};
constexpr Span kSpans[3] = {{7, 1, -1}, {0, 8, 0}, {0, 1, 8}};

/// Blocks whose corners the leaf's voxels touch: its own, and those beyond its upper faces that
/// hold a label.
void addOrigins(const LabelLeaf& leaf, std::vector<Coord>& origins) {
  const int32_t* values = leaf.buffer().data();
  bool used[8] = {};
  for (openvdb::Index i = 0; i < LabelLeaf::SIZE; ++i) {
    if (!labelAt(leaf, values, i)) continue;
    const int upper = ((i >> 6) == 7) * 4 + ((i >> 3 & 7) == 7) * 2 + ((i & 7) == 7);
    for (int side = 0; side < 8; ++side)
      if ((side & ~upper) == 0) used[side] = true;
  }
  for (int side = 0; side < 8; ++side)
    if (used[side])
      origins.push_back(leaf.origin() +
                        Coord(8 * (side >> 2), 8 * (side >> 1 & 1), 8 * (side & 1)));
}

/// The labels of `count` voxels of a leaf along z.
template <int count>
void readRow(const LabelLeaf& leaf, openvdb::Index offset, int32_t* to) {
  const int32_t* values = leaf.buffer().data() + offset;
  const auto active =
      uint32_t(leaf.getValueMask().getWord<uint64_t>(offset >> 6) >> (offset & 63) & 0xff);
  for (int k = 0; k < count; ++k) {
    const int32_t value = values[k] & -int32_t(active >> k & 1);
    to[k] = value > 0 ? value : 0;
  }
}

}  // namespace

Int32Tree::ConstPtr withoutTiles(const Int32Grid& labels) {
  if (!labels.tree().hasActiveTiles()) return labels.constTreePtr();
  const auto copy = std::make_shared<Int32Tree>(labels.tree());
  copy->voxelizeActiveTiles();
  return copy;
}

void readLabelHalo(const Int32Tree& tree, const Coord& origin, LabelHalo& halo) {
  const openvdb::tree::ValueAccessor<const Int32Tree, false> accessor(tree);
  for (int side = 0; side < 27; ++side) {
    const int dx = side / 9, dy = side / 3 % 3, dz = side % 3;
    const Coord from = origin.offsetBy(8 * dx - 8, 8 * dy - 8, 8 * dz - 8);
    const LabelLeaf* leaf = accessor.probeConstLeaf(from);
    int32_t tile = 0;
    if (!leaf && (!accessor.probeValue(from, tile) || tile < 0)) tile = 0;
    const Span x = kSpans[dx], y = kSpans[dy], z = kSpans[dz];
    for (int i = 0; i < x.count; ++i)
      for (int j = 0; j < y.count; ++j) {
        int32_t* to = &halo[haloAt(x.to + i, y.to + j, z.to)];
        const auto offset = openvdb::Index((x.from + i) * 64 + (y.from + j) * 8 + z.from);
        if (!leaf)
          std::fill(to, to + z.count, tile);
        else if (z.count == 8)
          readRow<8>(*leaf, offset, to);
        else
          readRow<1>(*leaf, offset, to);
      }
  }
}

LabelBlocks::LabelBlocks(const Int32Grid& labels) : tree_(withoutTiles(labels)) {
  for (const LabelLeaf* leaf : leavesOf(*tree_)) addOrigins(*leaf, origins_);
  sortUnique(origins_);
  for (const auto& [label, voxels] : labelSizes(labels)) {
    labels_.push_back(label);
    voxelCounts_.push_back(voxels);
  }
}

size_t LabelBlocks::find(const Coord& origin) const {
  return findSorted(origins_, origin).value_or(kNone);
}

uint32_t LabelBlocks::number(int32_t label) const {
  const auto dense = size_t(int64_t(label) - labels_.front());  // mostly there are no gaps
  if (dense < labels_.size() && labels_[dense] == label) return uint32_t(dense);
  return uint32_t(sortedIndex(labels_, label));
}

}  // namespace vdb_madf::detail
