// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/moved_labels.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

Coord floorToLeaf(const Coord& p) {
  return {p.x() & ~7, p.y() & ~7, p.z() & ~7};
}

/// The leaves that the voxels of some leaves come to lie in, ascending.
std::vector<Coord> targets(const std::vector<const Leaf*>& leaves, const Coord& shift) {
  std::vector<Coord> origins;
  for (const Leaf* leaf : leaves) {
    const Coord first = floorToLeaf(leaf->origin() + shift),
                last = floorToLeaf(leaf->origin() + shift + Coord(7));
    for (int x = first.x(); x <= last.x(); x += 8)
      for (int y = first.y(); y <= last.y(); y += 8)
        for (int z = first.z(); z <= last.z(); z += 8) origins.emplace_back(x, y, z);
  }
  std::sort(origins.begin(), origins.end());
  origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  return origins;
}

/// The leaf at an origin, of the (up to eight) leaves that its voxels come from; null if empty.
std::unique_ptr<Leaf> gathered(const Int32Tree& tree, const Coord& origin, const Coord& shift,
                               const CoordBBox& within) {
  const Coord from = origin - shift, base = floorToLeaf(from), inBase = from - base;
  std::array<const Leaf*, 8> sources{};
  for (int n = 0; n < 8; ++n)
    sources[size_t(n)] =
        tree.probeConstLeaf(base.offsetBy(8 * (n >> 2), 8 * (n >> 1 & 1), 8 * (n & 1)));
  auto leaf = std::make_unique<Leaf>(origin, 0);
  for (int offset = 0; offset < int(Leaf::SIZE); ++offset) {
    const int x = offset >> 6, y = offset >> 3 & 7, z = offset & 7;
    const int fromX = x + inBase.x(), fromY = y + inBase.y(), fromZ = z + inBase.z();
    const Leaf* source = sources[size_t((fromX >> 3) << 2 | (fromY >> 3) << 1 | fromZ >> 3)];
    if (!source) continue;
    const auto at = openvdb::Index((fromX & 7) << 6 | (fromY & 7) << 3 | (fromZ & 7));
    const int32_t label = labelAt(*source, source->buffer().data(), at);
    if (label > 0 && within.isInside(origin.offsetBy(x, y, z)))
      leaf->setValueOn(openvdb::Index(offset), label);
  }
  if (leaf->isEmpty()) leaf.reset();
  return leaf;
}

}  // namespace

Int32Grid::Ptr movedLabels(const Int32Grid& labels, const Coord& shift, const CoordBBox& within,
                           Interrupter* interrupter) {
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  std::vector<const Leaf*> leaves;
  tree->getNodes(leaves);
  const std::vector<Coord> origins = targets(leaves, shift);
  std::vector<std::unique_ptr<Leaf>> moved(origins.size());
  parallelForEach(origins.size(), kLeafGrain, interrupter,
                  [&](size_t n) { moved[n] = gathered(*tree, origins[n], shift, within); });
  const auto result = Int32Grid::create(0);
  for (std::unique_ptr<Leaf>& leaf : moved)
    if (leaf) result->tree().addLeaf(leaf.release());
  return result;
}

}  // namespace vdb_madf::detail
