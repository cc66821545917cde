// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/tree/ValueAccessor.h>

#include <memory>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// f(origin) for the leaf nodes of 8x8x8 voxels that a box meets: along z, then y, then x.
template <typename F>
void forEachLeafOrigin(const CoordBBox& box, const F& f) {
  if (box.empty()) return;
  const Coord low = box.min() & ~7, high = box.max();
  for (int x = low.x(); x <= high.x(); x += 8)
    for (int y = low.y(); y <= high.y(); y += 8)
      for (int z = low.z(); z <= high.z(); z += 8) f(Coord(x, y, z));
}

/// The leaf nodes of a tree, in its order.
template <typename Tree>
auto leavesOf(Tree& tree) {
  using Leaf = typename Tree::LeafNodeType;
  std::vector<std::conditional_t<std::is_const_v<Tree>, const Leaf*, Leaf*>> leaves;
  leaves.reserve(tree.leafCount());
  tree.getNodes(leaves);
  return leaves;
}

/// Adds to a tree the leaf nodes leafOf(n), n < count, which are made in parallel and may be null.
/// @throw Interrupted
template <typename Tree, typename LeafOf>
void addLeaves(Tree& tree, size_t count, size_t grain, Interrupter* interrupter,
               const LeafOf& leafOf) {
  std::vector<std::unique_ptr<typename Tree::LeafNodeType>> leaves(count);
  parallelForEach(count, grain, interrupter, [&](size_t n) { leaves[n] = leafOf(n); });
  openvdb::tree::ValueAccessor<Tree> accessor(tree);
  for (auto& leaf : leaves)
    if (leaf) accessor.addLeaf(leaf.release());
}

}  // namespace vdb_madf::detail
