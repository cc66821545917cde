// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The voxels of a box by their number, in the order of coordinates: x, then y, then z.
class DenseBox {
 public:
  explicit DenseBox(const CoordBBox& box)
      : box_(box), size_{box.dim().x(), box.dim().y(), box.dim().z()} {}

  const CoordBBox& box() const { return box_; }
  int64_t count() const { return size_[0] * size_[1] * size_[2]; }
  int64_t size(int axis) const { return size_[size_t(axis)]; }
  int64_t stride(int axis) const {
    return axis == 2 ? 1 : axis == 1 ? size_[2] : size_[1] * size_[2];
  }
  std::array<int64_t, 3> place(int64_t i) const {
    return {i / (size_[1] * size_[2]), i / size_[2] % size_[1], i % size_[2]};
  }
  Coord coord(int64_t i) const {
    const auto p = place(i);
    return box_.min() + Coord(int(p[0]), int(p[1]), int(p[2]));
  }
  int64_t index(const Coord& p) const {
    const Coord d = p - box_.min();
    return (d.x() * size_[1] + d.y()) * size_[2] + d.z();
  }
  /// Calls f(q) for the up to six face neighbors of a voxel that lie in the box.
  template <typename F>
  void forNeighbors(int64_t i, const F& f) const {
    const auto p = place(i);
    for (int axis = 0; axis < 3; ++axis) {
      if (p[size_t(axis)] > 0) f(i - stride(axis));
      if (p[size_t(axis)] + 1 < size(axis)) f(i + stride(axis));
    }
  }
  /// Calls f(first) in parallel for the first voxel of each row along an axis.
  template <typename F>
  void forRows(int axis, Interrupter* interrupter, const F& f) const {
    const int64_t inner = axis == 0 ? count() : axis == 1 ? size_[2] : 1;
    parallelFor(size_t(count() / size(axis)), 64, interrupter, [&](size_t begin, size_t end) {
      for (auto r = int64_t(begin); r < int64_t(end); ++r)
        f(r / inner * inner * size(axis) + r % inner);
    });
  }
  /// Calls f(i) in parallel for each voxel.
  template <typename F>
  void forAll(Interrupter* interrupter, const F& f) const {
    parallelFor(size_t(count()), 1 << 16, interrupter, [&](size_t begin, size_t end) {
      for (auto i = int64_t(begin); i < int64_t(end); ++i) f(i);
    });
  }
  /// |p - q|^2 by the weights.
  int64_t squaredLength(int64_t p, int64_t q, const std::array<int64_t, 3>& weights) const {
    const auto a = place(p), b = place(q);
    int64_t sum = 0;
    for (size_t axis = 0; axis < 3; ++axis)
      sum += weights[axis] * (a[axis] - b[axis]) * (a[axis] - b[axis]);
    return sum;
  }

 private:
  CoordBBox box_;
  std::array<int64_t, 3> size_;
};

/// Calls f(bounds, value) for each active voxel or tile.
template <typename Tree, typename F>
void forActive(const Tree& tree, const F& f) {
  for (auto it = tree.cbeginValueOn(); it; ++it) {
    CoordBBox bounds;
    it.getBoundingBox(bounds);
    f(bounds, it.getValue());
  }
}

/// Calls f(i) for the voxels of a box that lie in the dense one, and returns how many do not.
template <typename F>
int64_t forVoxels(const DenseBox& space, const CoordBBox& bounds, const F& f) {
  CoordBBox inside = bounds;
  inside.intersect(space.box());
  if (inside.empty()) return int64_t(bounds.volume());
  for (auto p = inside.begin(); p; ++p) f(space.index(*p));
  return int64_t(bounds.volume()) - int64_t(inside.volume());
}

}  // namespace vdb_madf::detail
