// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/relabelled.h"

#include <algorithm>
#include <memory>

#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using Pairs = std::vector<std::pair<int32_t, int32_t>>;

/// 0: background.
int32_t find(const Pairs& to, int32_t label) {
  const auto found = std::lower_bound(
      to.begin(), to.end(), label,
      [](const std::pair<int32_t, int32_t>& pair, int32_t wanted) { return pair.first < wanted; });
  return found != to.end() && found->first == label ? found->second : 0;
}

/// Null if nothing is left of the leaf.
std::unique_ptr<Leaf> relabelled(const Leaf& leaf, const Pairs& to) {
  auto changed = std::make_unique<Leaf>(leaf.origin(), 0);
  int32_t last = 0, label = 0;  // neighbors mostly share their label
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel != last) {
      last = *voxel;
      label = find(to, last);
    }
    if (label > 0) changed->setValueOn(voxel.pos(), label);
  }
  if (changed->isEmpty()) changed.reset();
  return changed;
}

}  // namespace

Int32Grid::Ptr relabelled(const Int32Grid& labels, const Pairs& to, Interrupter* interrupter) {
  const Int32Grid::Ptr result = labels.copyWithNewTree();
  auto tile = labels.tree().cbeginValueOn();
  tile.setMaxDepth(Int32Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (const int32_t label = find(to, *tile); label > 0)
      result->tree().sparseFill(tile.getBoundingBox(), label, true);

  const auto leaves = leavesOf(labels.tree());
  addLeaves(result->tree(), leaves.size(), kLeafGrain, interrupter,
            [&](size_t n) { return relabelled(*leaves[n], to); });
  return result;
}

void setVoxels(Int32Grid& labels, const std::vector<LeafIndex::LeafVoxels>& voxels, int32_t label) {
  for (const LeafIndex::LeafVoxels& part : voxels) {
    Leaf* leaf = labels.tree().touchLeaf(part.origin);
    for (size_t x = 0; x < 8; ++x)
      forEachBit(part.mask[x],
                 [&](int bit) { leaf->setValueOn(openvdb::Index(x * 64 + size_t(bit)), label); });
  }
}

}  // namespace vdb_madf::detail
