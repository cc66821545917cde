// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

/// Points in cubic cells, about one a cell.
class PointCells {
 public:
  using Point = openvdb::Vec3d;

  explicit PointCells(std::vector<Point> points) : points_(std::move(points)) {
    if (points_.empty()) return;
    Point upper = lower_ = points_[0];
    for (const Point& p : points_)
      for (int axis = 0; axis < 3; ++axis) {
        lower_[axis] = std::min(lower_[axis], p[axis]);
        upper[axis] = std::max(upper[axis], p[axis]);
      }
    Point extent = upper - lower_;
    const double longest = std::max({extent[0], extent[1], extent[2], 1e-9});
    double volume = 1;
    for (int axis = 0; axis < 3; ++axis) volume *= std::max(extent[axis], longest / 1000);
    side_ = std::cbrt(volume / double(points_.size()));
    for (int axis = 0; axis < 3; ++axis) count_[size_t(axis)] = int(extent[axis] / side_) + 1;
    first_.assign(size_t(count_[0]) * size_t(count_[1]) * size_t(count_[2]) + 1, 0);
    for (const Point& p : points_) ++first_[cellOf(p) + 1];
    for (size_t n = 1; n < first_.size(); ++n) first_[n] += first_[n - 1];
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    order_.resize(points_.size());
    for (size_t n = 0; n < points_.size(); ++n) order_[next[cellOf(points_[n])]++] = uint32_t(n);
  }

  const Point& operator[](size_t n) const { return points_[n]; }
  size_t size() const { return points_.size(); }
  double side() const { return side_; }
  /// All points, those of a cell one after the other.
  const std::vector<uint32_t>& inCells() const { return order_; }

  /// f(n, squared distance) for the points within a radius.
  template <typename F>
  void forEachWithin(const Point& p, double radius, const F& f) const {
    std::array<int, 3> low, high;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double from = (p[int(axis)] - radius - lower_[int(axis)]) / side_,
                   to = (p[int(axis)] + radius - lower_[int(axis)]) / side_;
      if (!(to >= 0 && from < count_[axis])) return;
      low[axis] = from > 0 ? int(from) : 0;
      high[axis] = to < count_[axis] ? int(to) : count_[axis] - 1;
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y) {
        const size_t row = (size_t(x) * size_t(count_[1]) + size_t(y)) * size_t(count_[2]);
        for (size_t at = first_[row + size_t(low[2])]; at < first_[row + size_t(high[2]) + 1]; ++at)
          if (const double squared = (points_[order_[at]] - p).lengthSqr();
              squared <= radius * radius)
            f(size_t(order_[at]), squared);
      }
  }

  /// The nearest points, the nearest first; of equally near ones the first. @param most above 0
  std::vector<size_t> nearest(const Point& p, size_t most) const {
    std::vector<std::pair<double, size_t>> found;
    const size_t wanted = std::min(most, size());
    for (double radius = side_ * std::cbrt(double(most)); found.size() < wanted; radius *= 2) {
      found.clear();
      forEachWithin(p, radius, [&](size_t n, double squared) { found.emplace_back(squared, n); });
    }
    std::sort(found.begin(), found.end());
    std::vector<size_t> result;
    for (size_t n = 0; n < wanted; ++n) result.push_back(found[n].second);
    return result;
  }

 private:
  size_t cellOf(const Point& p) const {
    size_t cell = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
      const int at = std::min(int((p[int(axis)] - lower_[int(axis)]) / side_), count_[axis] - 1);
      cell = cell * size_t(count_[axis]) + size_t(at);
    }
    return cell;
  }

  std::vector<Point> points_;
  Point lower_{0, 0, 0};
  double side_ = 1;
  std::array<int, 3> count_{1, 1, 1};
  std::vector<uint32_t> first_{0, 0}, order_;
};

}  // namespace vdb_madf::detail
