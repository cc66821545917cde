// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/scan_region.h"

#include <algorithm>

#include "vdb_madf/scans/detail/cylinder_axis.h"

namespace vdb_madf {

namespace {

constexpr int kLeaf = 8, kNode = 128;  // what tiles hold, along each side

/// Fills the voxels of a cylinder by blocks of its cross-section, so that only its wall has leaves.
class CylinderFill {
 public:
  CylinderFill(const CoordBBox& box, const Cylinder& cylinder)
      : box_(box),
        axis_{cylinder.axis, cylinder.center},
        squared_(cylinder.radius * cylinder.radius) {}

  MaskTree fill() {
    const Coord low = box_.min() & ~(kNode - 1);
    for (int u = low[axis_.u()]; u <= box_.max()[axis_.u()]; u += kNode)
      for (int v = low[axis_.v()]; v <= box_.max()[axis_.v()]; v += kNode) block(u, v, kNode);
    return std::move(tree_);
  }

 private:
  /// The part of the box whose cross-section is a square of the grid of nodes or leaves.
  void block(int u, int v, int side) {
    CoordBBox part = box_;
    part.min()[axis_.u()] = std::max(part.min()[axis_.u()], u);
    part.min()[axis_.v()] = std::max(part.min()[axis_.v()], v);
    part.max()[axis_.u()] = std::min(part.max()[axis_.u()], u + side - 1);
    part.max()[axis_.v()] = std::min(part.max()[axis_.v()], v + side - 1);
    if (part.empty() || axis_.nearest(part) > squared_) return;
    if (axis_.farthest(part) <= squared_) {
      tree_.sparseFill(part, true, true);
    } else if (side == kLeaf) {
      leaves(part);
    } else {
      for (int i = 0; i < side; i += kLeaf)
        for (int j = 0; j < side; j += kLeaf) block(u + i, v + j, kLeaf);
    }
  }

  void leaves(const CoordBBox& part) {
    const int along = axis_.axis;
    Coord origin = part.min() & ~(kLeaf - 1);
    for (; origin[along] <= part.max()[along]; origin[along] += kLeaf) {
      MaskTree::LeafNodeType* leaf = nullptr;
      for (openvdb::Index n = 0; n < MaskTree::LeafNodeType::SIZE; ++n) {
        const Coord p = origin + MaskTree::LeafNodeType::offsetToLocalCoord(n);
        if (!part.isInside(p) || axis_.squaredDistance(p) > squared_) continue;
        if (!leaf) leaf = tree_.touchLeaf(origin);
        leaf->setValueOn(n);
      }
    }
  }

  const CoordBBox box_;
  const detail::CylinderAxis axis_;
  const double squared_;
  MaskTree tree_;
};

}  // namespace

Domain cylinderIn(const CoordBBox& box, const Cylinder& cylinder) {
  return Domain(CylinderFill(box, cylinder).fill());
}

double largestRadius(const CoordBBox& box, int axis, const std::array<double, 2>& center) {
  const detail::CylinderAxis around{axis, center};
  return std::min({center[0] - box.min()[around.u()] + 0.5, box.max()[around.u()] - center[0] + 0.5,
                   center[1] - box.min()[around.v()] + 0.5,
                   box.max()[around.v()] - center[1] + 0.5});
}

}  // namespace vdb_madf
