// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/moved_labels.h"

#include <openvdb/tree/ValueAccessor.h>

#include <array>
#include <memory>
#include <vector>

#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

/// The leaves that the voxels of some leaves come to lie in, ascending.
std::vector<Coord> targets(const std::vector<const Leaf*>& leaves, const Coord& shift) {
  std::vector<Coord> origins;
  for (const Leaf* leaf : leaves) {
    CoordBBox moved = leaf->getNodeBoundingBox();
    moved.translate(shift);
    forEachLeafOrigin(moved, [&](const Coord& origin) { origins.push_back(origin); });
  }
  sortUnique(origins);
  return origins;
}

/// Tells the voxels that a scan shows.
class IsShown {
 public:
  explicit IsShown(const Shown& shown)
      : box_(shown.domain ? shown.domain->box() : CoordBBox::inf()), shift_(shown.shift) {
    if (shown.domain && !shown.domain->isBox()) region_.emplace(*shown.domain->region());
  }
  bool operator()(const Coord& p) const {
    return region_ ? region_->isValueOn(p - shift_) : box_.isInside(p - shift_);
  }

 private:
  CoordBBox box_;
  Coord shift_;
  std::optional<openvdb::tree::ValueAccessor<const MaskTree>> region_;
};

/// The leaf at an origin, of the (up to eight) leaves that its voxels come from; null if empty.
std::unique_ptr<Leaf> gathered(const Int32Tree& tree, const Coord& origin, const Coord& shift,
                               const Shown& shown) {
  const Coord from = origin - shift, base = from & ~7, inBase = from - base;
  std::array<const Leaf*, 8> sources{};
  for (int n = 0; n < 8; ++n)
    sources[size_t(n)] =
        tree.probeConstLeaf(base.offsetBy(8 * (n >> 2), 8 * (n >> 1 & 1), 8 * (n & 1)));
  const IsShown isShown(shown);
  auto leaf = std::make_unique<Leaf>(origin, 0);
  for (int offset = 0; offset < int(Leaf::SIZE); ++offset) {
    const int x = offset >> 6, y = offset >> 3 & 7, z = offset & 7;
    const int fromX = x + inBase.x(), fromY = y + inBase.y(), fromZ = z + inBase.z();
    const Leaf* source = sources[size_t((fromX >> 3) << 2 | (fromY >> 3) << 1 | fromZ >> 3)];
    if (!source) continue;
    const auto at = openvdb::Index((fromX & 7) << 6 | (fromY & 7) << 3 | (fromZ & 7));
    const int32_t label = labelAt(*source, source->buffer().data(), at);
    if (label > 0 && isShown(origin.offsetBy(x, y, z)))
      leaf->setValueOn(openvdb::Index(offset), label);
  }
  if (leaf->isEmpty()) leaf.reset();
  return leaf;
}

}  // namespace

Int32Grid::Ptr movedLabels(const Int32Grid& labels, const Coord& shift, const Shown& shown,
                           Interrupter* interrupter) {
  const Int32Tree::ConstPtr tree = withoutTiles(labels);
  const std::vector<Coord> origins = targets(leavesOf(*tree), shift);
  const auto result = Int32Grid::create(0);
  addLeaves(result->tree(), origins.size(), kLeafGrain, interrupter,
            [&](size_t n) { return gathered(*tree, origins[n], shift, shown); });
  return result;
}

}  // namespace vdb_madf::detail
