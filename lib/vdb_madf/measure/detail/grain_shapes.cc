// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/grain_shapes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/measure/detail/convex_hull.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;

constexpr size_t kTogether = 4;  // grains

using Row = GrainShapes::Row;

void addRows(const LabelPart& part, const Coord& origin, std::vector<Row>& rows) {
  for (int x = 0; x < 8; ++x)
    for (int y = 0; y < 8; ++y)
      if (const auto bits = unsigned(part.mask[size_t(x)] >> 8 * y & 0xff))
        rows.push_back({origin.x() + x, origin.y() + y, origin.z() + __builtin_ctz(bits),
                        origin.z() + 31 - __builtin_clz(bits)});
}

/// One of each place, sorted by x, then y.
void joinRows(std::vector<Row>& rows) {
  std::sort(rows.begin(), rows.end(),
            [](const Row& a, const Row& b) { return std::tie(a.x, a.y) < std::tie(b.x, b.y); });
  size_t joined = 0;
  for (const Row& row : rows) {
    Row* last = joined > 0 ? &rows[joined - 1] : nullptr;
    if (last && last->x == row.x && last->y == row.y) {
      last->first = std::min(last->first, row.first);
      last->last = std::max(last->last, row.last);
    } else {
      rows[joined++] = row;
    }
  }
  rows.resize(joined);
}

/// The lower side of the polygon around points that come by ascending y.
class LowerChain {
 public:
  void add(int64_t y, int64_t z) {
    while (points_.size() > 1 && !turnsUp(points_.end()[-2], points_.back(), {y, z}))
      points_.pop_back();
    points_.push_back({y, z});
  }
  const std::vector<std::pair<int64_t, int64_t>>& points() const { return points_; }

 private:
  using Point = std::pair<int64_t, int64_t>;
  static bool turnsUp(const Point& a, const Point& b, const Point& c) {
    return (b.first - a.first) * (c.second - a.second) >
           (b.second - a.second) * (c.first - a.first);
  }
  std::vector<Point> points_;
};

/// The corners of the voxels of one x, as far as they may be corners of a hull. Corner p is the
/// point p - 1/2.
void addCorners(const Row* begin, const Row* end, std::vector<Coord>& corners) {
  LowerChain lower, upper;  // upside down
  for (const Row* row = begin; row != end; ++row)
    for (const int y : {row->y, row->y + 1}) {
      lower.add(y, row->first);
      upper.add(y, -int64_t(row->last) - 1);
    }
  for (const int x : {begin->x, begin->x + 1}) {
    for (const auto& [y, z] : lower.points()) corners.emplace_back(x, int(y), int(z));
    for (const auto& [y, z] : upper.points()) corners.emplace_back(x, int(y), int(-z));
  }
}

/// \p rows as joinRows() leaves them, not empty.
GrainShape shapeOf(const std::vector<Row>& rows, const VoxelShape& voxel) {
  std::vector<Coord> corners;
  for (auto row = rows.begin(); row != rows.end();) {
    const auto next =
        std::find_if(row, rows.end(), [&](const Row& other) { return other.x != row->x; });
    addCorners(&*row, &*row + (next - row), corners);
    row = next;
  }
  sortUnique(corners);
  std::vector<Vec3d> points;
  points.reserve(corners.size());
  for (const Coord& corner : corners)
    points.push_back((corner - corners.front()).asVec3d() * voxel.edges);
  const ConvexHull hull = convexHull(points);
  return {diameter(hull), leastWidth(hull), hull.volume, std::sqrt(hull.area / M_PI)};
}

/// The parts of the leaves by grain.
class PartsOfGrains {
 public:
  struct Part {
    size_t leaf;
    const LabelPart* voxels;
  };

  explicit PartsOfGrains(const LabelLeaves& labels) {
    const size_t leaves = labels.index().leafCount();
    for (size_t leaf = 0; leaf < leaves; ++leaf)
      for (const LabelPart& part : labels.parts(leaf)) parts_.push_back({leaf, &part});
    parallelSort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) {
      return std::tie(a.voxels->label, a.leaf) < std::tie(b.voxels->label, b.leaf);
    });
    for (size_t i = 0; i < parts_.size(); ++i)
      if (i == 0 || parts_[i].voxels->label != parts_[i - 1].voxels->label) first_.push_back(i);
    first_.push_back(parts_.size());
  }
  size_t grains() const { return first_.size() - 1; }
  int32_t label(size_t grain) const { return begin(grain)->voxels->label; }
  const Part* begin(size_t grain) const { return parts_.data() + first_[grain]; }
  const Part* end(size_t grain) const { return parts_.data() + first_[grain + 1]; }

 private:
  std::vector<size_t> first_;
  std::vector<Part> parts_;
};

}  // namespace

void GrainShapes::add(const LabelLeaves& slab, const std::function<bool(int32_t label)>& isComplete,
                      Interrupter* interrupter) {
  const PartsOfGrains parts(slab);
  std::vector<std::vector<Row>> rowsOfOpen(parts.grains());
  std::vector<GrainShape> shapes(parts.grains());
  parallelForEach(parts.grains(), kTogether, interrupter, [&](size_t i) {
    std::vector<Row> rows;
    if (const auto open = open_.find(parts.label(i)); open != open_.end()) rows = open->second;
    for (const auto* part = parts.begin(i); part != parts.end(i); ++part)
      addRows(*part->voxels, slab.index().origin(part->leaf), rows);
    joinRows(rows);
    if (isComplete(parts.label(i)))
      shapes[i] = shapeOf(rows, voxel_);
    else
      rowsOfOpen[i] = std::move(rows);
  });
  for (size_t i = 0; i < parts.grains(); ++i) {
    const int32_t label = parts.label(i);
    if (rowsOfOpen[i].empty()) {
      shapes_[label] = shapes[i];
      open_.erase(label);
    } else {
      open_[label] = std::move(rowsOfOpen[i]);
    }
  }
}

}  // namespace vdb_madf::detail
