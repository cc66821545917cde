// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/voxel_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "vdb_madf/base/detail/simd.h"

namespace vdb_madf::detail {

namespace {

using Vec = openvdb::Vec3d;
using MaskLeaf = MaskTree::LeafNodeType;

/// A walk through the cells of a lattice along a ray: Amanatides & Woo 1987. Cell (i, j, k) is the
/// box from (i, j, k) * size to (i + 1, j + 1, k + 1) * size, along each axis.
class CellWalk {
 public:
  /// From the ray's point at `t` on, which lies in (or, for rounding, next to) the cells from `low`
  /// to `high`.
  CellWalk(const Vec& origin, const Vec& direction, double t, const Vec& size, const Coord& low,
           const Coord& high)
      : origin_(origin), direction_(direction), size_(size), t_(t) {
    for (int axis = 0; axis < 3; ++axis) {
      const double p = (origin[axis] + t * direction[axis]) / size[axis];
      cell_[axis] = std::clamp(int(std::floor(p)), low[axis], high[axis]);
      setNext(axis);
    }
  }
  const Coord& cell() const { return cell_; }
  double t() const { return t_; }  ///< where the ray enters the cell
  void advance() {
    int axis = next_[0] <= next_[1] ? 0 : 1;
    if (next_[2] < next_[axis]) axis = 2;
    t_ = std::max(t_, next_[axis]);
    cell_[axis] += direction_[axis] > 0 ? 1 : -1;
    setNext(axis);
  }

 private:
  void setNext(int axis) {
    next_[axis] = direction_[axis] == 0
                      ? std::numeric_limits<double>::infinity()
                      : ((cell_[axis] + (direction_[axis] > 0)) * size_[axis] - origin_[axis]) /
                            direction_[axis];
  }
  const Vec& origin_;
  const Vec& direction_;
  const Vec& size_;
  Coord cell_;
  double t_;
  double next_[3];
};

/// The first voxel of a leaf that a ray meets, from its point at `t` on, which lies in (or, for
/// rounding, next to) the leaf; `t` becomes where it enters that voxel. The walk of CellWalk, with
/// the crossings of all planes found at once, and no branch on the axis. No sums whose order the
/// compiler chooses: the same bits for all instruction sets.
VDB_MADF_KERNEL bool firstInLeaf(const MaskLeaf& leaf, const Coord& corner, const Vec& origin,
                                 const Vec& direction, const Vec& size, Coord& voxel, double& t) {
  // Voxels are counted in the direction of the ray: x in bits 8 to 10 of `place`, y in 4 to 6, z in
  // 0 to 2. The bit above tells that the ray has left the leaf.
  constexpr unsigned kLeft = 0x888;
  unsigned place = 0, backwards = 0;
  double next[3][8];  // where the ray leaves a voxel
  for (int axis = 0; axis < 3; ++axis) {
    const double o = origin[axis], d = direction[axis], edge = size[axis];
    const bool up = d > 0;
    const int first =
        std::clamp(int(std::floor((o + t * d) / edge)), corner[axis], corner[axis] + 7);
    const int shift = 8 - 4 * axis;
    place |= unsigned(up ? first - corner[axis] : corner[axis] + 7 - first) << shift;
    backwards |= (up ? 0u : 7u) << shift;
    const int plane = corner[axis] + (up ? 1 : 7), step = up ? 1 : -1;
    if (d == 0)
      for (double& crossing : next[axis]) crossing = std::numeric_limits<double>::infinity();
    else
      for (int i = 0; i < 8; ++i) next[axis][i] = ((plane + step * i) * edge - o) / d;
  }
  while (true) {
    const unsigned at = place ^ backwards;
    const unsigned offset = (at >> 2 & 0x1c0) | (at >> 1 & 0x38) | (at & 7);
    if (leaf.getValueMask().isOn(offset)) {
      voxel = corner + Coord(int(at >> 8), int(at >> 4 & 7), int(at & 7));
      return true;
    }
    const double x = next[0][place >> 8], y = next[1][place >> 4 & 7], z = next[2][place & 7];
    const unsigned isY = y < x;
    const double xy = y < x ? y : x;
    const unsigned isZ = z < xy;
    t = std::max(t, z < xy ? z : xy);
    place += 0x100u >> 4 * (isZ * 2 | (isY & ~isZ));
    if (place & kLeft) return false;
  }
}

/// The part of a ray within [low, high].
struct Span {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();

  Span(const Vec& origin, const Vec& direction, const Vec& low, const Vec& high) {
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0) {
        if (origin[axis] < low[axis] || origin[axis] > high[axis]) end = begin;
        continue;
      }
      double a = (low[axis] - origin[axis]) / direction[axis];
      double b = (high[axis] - origin[axis]) / direction[axis];
      if (a > b) std::swap(a, b);
      begin = std::max(begin, a);
      end = std::min(end, b);
    }
  }
  bool empty() const { return !(begin < end); }
};

}  // namespace

VoxelRays::VoxelRays(const MaskGrid::ConstPtr& object, const CoordBBox& box, const Vec& edges,
                     const Vec& direction)
    : object_(object), edges_(edges), leafEdges_(8 * edges), direction_(direction) {
  for (int axis = 0; axis < 3; ++axis) {
    low_[axis] = edges[axis] * box.min()[axis];
    high_[axis] = edges[axis] * (box.max()[axis] + 1);
    leafLow_[axis] = box.min()[axis] >> 3;
    leafHigh_[axis] = box.max()[axis] >> 3;
  }
}

bool VoxelRays::first(const MaskGrid::ConstUnsafeAccessor& accessor, const Vec& origin,
                      Coord& voxel, double& t) const {
  const Span span(origin, direction_, low_, high_);
  if (span.empty()) return false;
  CellWalk leaves(origin, direction_, span.begin, leafEdges_, leafLow_, leafHigh_);
  for (; leaves.t() < span.end; leaves.advance()) {
    const Coord cell = leaves.cell();  // times 8: negative numbers must not be shifted left
    const Coord corner(cell.x() * 8, cell.y() * 8, cell.z() * 8);
    const MaskLeaf* leaf = accessor.probeConstLeaf(corner);
    if (!leaf) continue;
    t = leaves.t();
    if (atBestLevel([&]() VDB_MADF_INLINE {
          return firstInLeaf(*leaf, corner, origin, direction_, edges_, voxel, t);
        }))
      return true;
  }
  return false;
}

}  // namespace vdb_madf::detail
