// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/ball_reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

class BallReach {
 public:
  BallReach(const CriticalPoint& point, const Domain& domain, const VoxelWeights& weights)
      : center_(point.position),
        squaredRadius_(point.squaredRadius),
        weights_(weights),
        domain_(domain) {}

  bool leavesBox() const {
    const CoordBBox& box = domain_.box();
    for (int axis = 0; axis < 3; ++axis) {
      if (domain_.flatAxis() == axis) continue;
      Coord before = center_, after = center_;  // the nearest voxels outside are straight on
      before[axis] = box.min()[axis] - 1;
      after[axis] = box.max()[axis] + 1;
      if (isNear(before) || isNear(after)) return true;
    }
    return false;
  }

  bool leavesRegion() const {
    CoordBBox ball(center_, center_);
    for (int axis = 0; axis < 3; ++axis) {
      const int reach = int(std::sqrt(double(squaredRadius_) / weights_[axis])) + 1;
      ball.min()[axis] -= reach;
      ball.max()[axis] += reach;
    }
    ball.intersect(domain_.box());
    return meetsOutside(RegionLook(*domain_.region()), ball, 0);
  }

 private:
  using RegionLook = openvdb::tree::ValueAccessor<const MaskTree>;
  using Upper = MaskTree::RootNodeType::ChildNodeType;
  static constexpr int64_t kFarthest = 46340;  // its square is the largest below 2^31

  /// Edges of the nodes of the tree, by their depth, which begins with 1.
  static constexpr std::array<int, 3> kEdges{int(Upper::DIM), int(Upper::ChildNodeType::DIM),
                                             int(MaskTree::LeafNodeType::DIM)};

  bool isNear(const Coord& voxel) const {
    int64_t squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t steps = int64_t(voxel[axis]) - center_[axis];
      if (std::abs(steps) > kFarthest) return false;
      squared += weights_[axis] * steps * steps;
    }
    return squared < squaredRadius_;
  }

  /// Looks at what nodes of a depth, or tiles in their place, have in a box.
  bool meetsOutside(const RegionLook& region, const CoordBBox& box, size_t depth) const {
    const int edge = kEdges[depth];
    Coord node;
    for (node.x() = box.min().x() & -edge; node.x() <= box.max().x(); node.x() += edge)
      for (node.y() = box.min().y() & -edge; node.y() <= box.max().y(); node.y() += edge)
        for (node.z() = box.min().z() & -edge; node.z() <= box.max().z(); node.z() += edge) {
          CoordBBox part = CoordBBox::createCube(node, edge);
          part.intersect(box);
          if (!isNear(nearest(part))) continue;
          if (region.getValueDepth(node) <= int(depth)) {  // a tile, or the background
            if (!region.isValueOn(node)) return true;
          } else if (depth + 1 < kEdges.size() ? meetsOutside(region, part, depth + 1)
                                               : meetsOutside(*region.probeConstLeaf(node), part)) {
            return true;
          }
        }
    return false;
  }

  bool meetsOutside(const MaskTree::LeafNodeType& leaf, const CoordBBox& box) const {
    const LeafIndex::Mask outside = without(kFullMask, maskOf(leaf));
    bool found = false;
    for (uint32_t x = 0; x < 8; ++x)
      forEachBit(outside[x], [&](int bit) {
        const Coord voxel = leaf.origin() + Coord(int(x), bit >> 3, bit & 7);
        found = found || (box.isInside(voxel) && isNear(voxel));
      });
    return found;
  }

  Coord nearest(const CoordBBox& box) const {
    return Coord::minComponent(Coord::maxComponent(center_, box.min()), box.max());
  }

  const Coord center_;
  const int64_t squaredRadius_;
  const VoxelWeights& weights_;
  const Domain& domain_;
};

}  // namespace

bool reachesOut(const CriticalPoint& point, const Domain& domain, const VoxelWeights& weights) {
  const BallReach ball(point, domain, weights);
  return ball.leavesBox() || (!domain.isBox() && ball.leavesRegion());
}

}  // namespace vdb_madf::detail
