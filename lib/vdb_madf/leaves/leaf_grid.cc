// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/leaf_grid.h"

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/detail/pages.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

/// Leaves per task: some hundred microseconds.
constexpr size_t kGridGrain = 512;

/// done(begin, end) tells the ranks that are not asked for again.
template <typename Value, typename Done>
Int32Grid::Ptr makeGrid(const LeafIndex& index, const std::string& name, Interrupter* interrupter,
                        const Value& value, const Done& done) {
  using Leaf = Int32Tree::LeafNodeType;
  std::vector<std::unique_ptr<Leaf>> leaves(index.leafCount());
  detail::parallelFor(leaves.size(), kGridGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      leaves[i] = std::make_unique<Leaf>(openvdb::PartialCreate(), index.origin(i));
      leaves[i]->buffer().allocate();
      int32_t* to = leaves[i]->buffer().data();
      std::fill(to, to + 512, 0);
      size_t rank = index.firstRank(i);
      Leaf::NodeMaskType mask;
      for (size_t x = 0; x < 8; ++x) {
        mask.template getWord<uint64_t>(int(x)) = index.mask(i)[x];
        detail::forEachBit(index.mask(i)[x],
                           [&](int bit) { to[x * 64 + size_t(bit)] = value(rank++); });
      }
      leaves[i]->setValueMask(mask);
    }
    done(index.firstRank(begin), index.firstRank(end));
  });
  auto grid = Int32Grid::create(0);
  grid->setName(name);
  openvdb::tree::ValueAccessor<Int32Tree, false> tree(grid->tree());
  for (auto& leaf : leaves) tree.addLeaf(leaf.release());
  return grid;
}

}  // namespace

Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<int32_t>& values,
                      const std::string& name, Interrupter* interrupter) {
  return makeGrid(
      index, name, interrupter, [&](size_t rank) { return values[rank]; }, [](size_t, size_t) {});
}

Int32Grid::Ptr toGrid(const LeafIndex& index, const VoxelArray<uint32_t>& values,
                      const std::string& name, Interrupter* interrupter) {
  return makeGrid(
      index, name, interrupter, [&](size_t rank) { return int32_t(values[rank] & 0x7fffffffu); },
      [](size_t, size_t) {});
}

Int32Grid::Ptr toGrid(const LeafIndex& index, VoxelArray<uint32_t>&& values,
                      const std::string& name, Interrupter* interrupter) {
  constexpr size_t kBytes = sizeof(uint32_t);
  detail::PageReturn memory(values.data(), values.size() * kBytes);
  return makeGrid(
      index, name, interrupter, [&](size_t rank) { return int32_t(values[rank] & 0x7fffffffu); },
      [&](size_t begin, size_t end) { memory.giveBack(begin * kBytes, end * kBytes); });
}

void removeVoxels(Int32Grid& grid, const LeafIndex& index, const std::vector<VoxelId>& voxels) {
  constexpr openvdb::Index kLeafTile = 1;  // level of a tile as large as a leaf
  for (size_t i = 0; i < voxels.size();) {
    const uint32_t number = leafOf(voxels[i]);
    const Coord& origin = index.origin(number);
    Int32Tree::LeafNodeType* leaf = grid.tree().probeLeaf(origin);
    for (; i < voxels.size() && leafOf(voxels[i]) == number; ++i)
      leaf->setValueOff(offsetOf(voxels[i]), 0);
    if (leaf->isEmpty()) grid.tree().addTile(kLeafTile, origin, 0, false);
  }
}

}  // namespace vdb_madf
