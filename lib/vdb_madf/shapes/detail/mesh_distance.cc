// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

/// Voxels; whole leaves. The distances of a block stay in a core's cache.
constexpr int kBlockShift = 6, kBlockSide = 1 << kBlockShift;
/// Voxels: so much farther than it could be, voxels are measured to a feature.
constexpr double kSlack = 1e-4;
/// Of a triangle's height: voxels so far beside it still count as above it.
constexpr double kBeside = 1e-6;
/// Triangles that turn by less (1 - cosine) have no wedge between them: their slack fills it.
constexpr double kFlat = 1e-14;
/// Wedges of a smaller cosine are searched in the whole reach around their edges, those with normals
/// along the axis of less than kLeastSlope in a box.
constexpr double kWide = -0.9, kLeastSlope = 0.2;

// Of values that fit; without SSE 4.1 those of the standard are calls.
int floorOf(double value) {
  const int whole = int(value);
  return whole - (double(whole) > value);
}
int ceilOf(double value) {
  const int whole = int(value);
  return whole + (double(whole) < value);
}

struct Range {
  double low, high;

  void include(const Range& o) {
    low = std::min(low, o.low);
    high = std::max(high, o.high);
  }
};

Range rangeOf(double a, double b) {
  return {std::min(a, b), std::max(a, b)};
}

/// The squared distances of a block, with voxels more on both sides along z, which nobody reads.
class BlockDistances {
 public:
  BlockDistances(const CoordBBox& box, float reach)
      : box_(box),
        reach_(reach),
        steps_(int(std::ceil(reach))),
        width_((2 * steps_ + 2 + 7) / 8 * 8),
        beside_(width_),
        rowLength_(box.dim().z() + 2 * beside_),
        squares_(size_t(box.dim().x()) * size_t(box.dim().y()) * size_t(rowLength_),
                 reach * reach) {}

  void addPoint(const Vec3f& point) {
    Coord cell;
    Vec3f rest;  // exact, so that no digits are lost far from the origin
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = floorOf(double(point[axis]));
      rest[axis] = point[axis] - float(cell[axis]);
    }
    std::array<float, kMaxWidth> along;
    for (int i = 0; i < width_; ++i) {
      const float dz = float(i - steps_) - rest.z();
      along[size_t(i)] = dz * dz;
    }
    const float farthest = reach_ * reach_;
    for (int x = std::max(cell.x() - steps_, box_.min().x());
         x <= std::min(cell.x() + steps_ + 1, box_.max().x()); ++x) {
      const float dx = float(x - cell.x()) - rest.x();
      for (int y = std::max(cell.y() - steps_, box_.min().y());
           y <= std::min(cell.y() + steps_ + 1, box_.max().y()); ++y) {
        const float dy = float(y - cell.y()) - rest.y(), across = dx * dx + dy * dy;
        if (across >= farthest) continue;
        float* row = &squares_[place(x, y, cell.z() - steps_)];
        for (int i = 0; i < width_; i += 8)
          for (int j = i; j < i + 8; ++j) {
            const float square = across + along[size_t(j)];
            row[j] = square < row[j] ? square : row[j];
          }
      }
    }
  }

  void addTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = b - a, ac = c - a, normal = ab.cross(ac);
    const double area = normal.lengthSqr();  // of the parallelogram, squared
    if (area == 0) return;
    const int axis = longest(normal), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double slopeU = normal[u] / normal[axis], slopeV = normal[v] / normal[axis],
                 height = reach_ * std::abs(normal[axis]) / std::sqrt(area);
    Range alongU{kFar, -kFar}, alongV = alongU, heights = alongU;  // at height 0 along the normal
    for (const Vec3d* corner : {&a, &b, &c}) {
      const Vec3d& p = *corner;
      alongU.include({p[u] - p[axis] * slopeU, p[u] - p[axis] * slopeU});
      alongV.include({p[v] - p[axis] * slopeV, p[v] - p[axis] * slopeV});
      heights.include({p[axis] - height, p[axis] + height});
    }
    const double bb = ab.lengthSqr(), cc = ac.lengthSqr(), bc = ab.dot(ac), least = -kBeside * area,
                 most = area - 2 * least;
    forEachIn(
        axis, heights,
        [&](double k) {
          return std::pair(Range{alongU.low + k * slopeU, alongU.high + k * slopeU},
                           Range{alongV.low + k * slopeV, alongV.high + k * slopeV});
        },
        [&](const Vec3d& p, float& square) {
          const Vec3d away = p - a;
          const double alongB = away.dot(ab), alongC = away.dot(ac),
                       toB = cc * alongB - bc * alongC, toC = bb * alongC - bc * alongB;
          if (toB < least || toC < least || toB + toC > most) return;
          const double up = away.dot(normal);
          square = std::min(square, float(up * up / area));
        });
  }

  /// The edge from a to b of two triangles with these unit normals (0: they have no area); `isConvex`
  /// if the second one bends away from the normal of the first.
  void addEdge(const Vec3d& a, const Vec3d& b, Vec3d one, Vec3d other, bool isConvex) {
    const double cosine = one.dot(other);
    if (cosine > 1 - kFlat) return;
    if (!isConvex) {
      one = -one;
      other = -other;
    }
    const Vec3d middle = one + other, edge = b - a;
    const double length = edge.lengthSqr();
    if (length == 0) return;
    // What is within reach between the normals is a sum of them whose weights are at most this one.
    const bool isWide = cosine < kWide || one == Vec3d(0) || other == Vec3d(0);
    const double weight = isWide ? 0 : reach_ * std::sqrt(2 / (1 + cosine));
    std::array<Range, 3> box;
    for (int i = 0; i < 3; ++i) {
      const Range normals =
          isWide ? Range{-kFar, kFar} : rangeOf(weight * one[i], weight * other[i]);
      box[size_t(i)] = {std::min(a[i], b[i]) + std::clamp(normals.low, -reach_, 0.0),
                        std::max(a[i], b[i]) + std::clamp(normals.high, 0.0, reach_)};
    }
    const int axis = longest(middle), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto measure = [&](const Vec3d& p, float& square) {
      const Vec3d away = p - a;
      const double along = away.dot(edge);
      if (along < 0 || along > length) return;  // nearer to an end
      square = std::min(square, float((away - along / length * edge).lengthSqr()));
    };
    // In a slice across the axis the wedge is what lies between the normals from both ends.
    const double sign = middle[axis] < 0 ? -1 : 1;
    const bool isBox = isWide || std::min(sign * one[axis], sign * other[axis]) < kLeastSlope;
    const auto across = [&](double k, int side) {
      const Range& range = box[size_t(side)];
      if (isBox) return range;
      const double slope = one[side] / one[axis], slope2 = other[side] / other[axis],
                   up = k - a[axis], up2 = k - b[axis];
      Range lines = rangeOf(a[side] + up * slope, a[side] + up * slope2);
      lines.include(rangeOf(b[side] + up2 * slope, b[side] + up2 * slope2));
      return Range{std::max(range.low, lines.low), std::min(range.high, lines.high)};
    };
    forEachIn(
        axis, box[size_t(axis)], [&](double k) { return std::pair(across(k, u), across(k, v)); },
        measure);
  }

  std::vector<float> squares() const {
    std::vector<float> result;
    result.reserve(size_t(box_.volume()));
    for (int x = box_.min().x(); x <= box_.max().x(); ++x)
      for (int y = box_.min().y(); y <= box_.max().y(); ++y) {
        const float* row = &squares_[place(x, y, box_.min().z())];
        result.insert(result.end(), row, row + box_.dim().z());
      }
    return result;
  }

 private:
  static constexpr double kFar = 1e30;
  static constexpr size_t kMaxWidth = 40;

  static int longest(const Vec3d& v) {
    const double x = std::abs(v[0]), y = std::abs(v[1]), z = std::abs(v[2]);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  }

  size_t place(int x, int y, int z) const {
    return (size_t(x - box_.min().x()) * size_t(box_.dim().y()) + size_t(y - box_.min().y())) *
               size_t(rowLength_) +
           size_t(z - box_.min().z() + beside_);
  }

  /// f(place, square) for the voxels of the block in ranges across an axis: those of the slice k
  /// along it are rectangleOf(k), along the two axes after it.
  template <typename RectangleOf, typename F>
  void forEachIn(int axis, const Range& heights, const RectangleOf& rectangleOf, const F& f) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Coord p;
    const int first = std::max(ceilOf(heights.low - kSlack), box_.min()[axis]),
              last = std::min(floorOf(heights.high + kSlack), box_.max()[axis]);
    for (p[axis] = first; p[axis] <= last; ++p[axis]) {
      const auto [alongU, alongV] = rectangleOf(double(p[axis]));
      const int lastU = std::min(floorOf(alongU.high + kSlack), box_.max()[u]),
                firstV = std::max(ceilOf(alongV.low - kSlack), box_.min()[v]),
                lastV = std::min(floorOf(alongV.high + kSlack), box_.max()[v]);
      for (p[u] = std::max(ceilOf(alongU.low - kSlack), box_.min()[u]); p[u] <= lastU; ++p[u])
        for (p[v] = firstV; p[v] <= lastV; ++p[v])
          f(p.asVec3d(), squares_[place(p.x(), p.y(), p.z())]);
    }
  }

  CoordBBox box_;
  double reach_;
  int steps_, width_, beside_, rowLength_;
  std::vector<float> squares_;
};

Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = (b - a).cross(c - a);
  const double length = normal.length();
  return length > 0 ? normal * (1 / length) : Vec3d(0);
}

std::vector<std::array<uint32_t, 3>> trianglesOf(const GrainMesh& mesh, size_t grain) {
  std::vector<std::array<uint32_t, 3>> triangles(
      mesh.triangles.begin() + mesh.firstTriangle[grain],
      mesh.triangles.begin() + mesh.firstTriangle[grain + 1]);
  for (auto& triangle : triangles)
    for (uint32_t& corner : triangle) corner -= mesh.firstPoint[grain];
  return triangles;
}

std::vector<uint32_t> cornersOf(const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<uint32_t> corners;
  corners.reserve(3 * triangles.size());
  for (const auto& triangle : triangles)
    corners.insert(corners.end(), triangle.begin(), triangle.end());
  return corners;
}

}  // namespace

MeshDistance::MeshDistance(const GrainMesh& mesh, size_t grain, float reach)
    : points_(mesh.points.data() + mesh.firstPoint[grain]),
      pointCount_(mesh.firstPoint[grain + 1] - mesh.firstPoint[grain]),
      triangles_(trianglesOf(mesh, grain)),
      reach_(reach),
      cornersOfPoint_(cornersOf(triangles_), pointCount_) {
  listBlocks();
}

CoordBBox MeshDistance::reached(const Vec3f& low, const Vec3f& high) const {
  CoordBBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min()[axis] = ceilOf(double(low[axis]) - double(reach_));
    box.max()[axis] = floorOf(double(high[axis]) + double(reach_));
  }
  return box;
}

void MeshDistance::listBlocks() {
  CoordBBox whole;
  for (uint32_t i = 0; i < pointCount_; ++i) whole.expand(reached(points_[i], points_[i]));
  if (whole.empty()) return;
  const Coord low = whole.min() & ~7, high = (whole.max() & ~7).offsetBy(7);
  const Coord count = ((high - low) >> kBlockShift).offsetBy(1);
  for (int x = 0; x < count.x(); ++x)
    for (int y = 0; y < count.y(); ++y)
      for (int z = 0; z < count.z(); ++z) {
        const Coord start = low.offsetBy(x * kBlockSide, y * kBlockSide, z * kBlockSide);
        blocks_.emplace_back(start, Coord::minComponent(high, start.offsetBy(kBlockSide - 1)));
      }
  pointsOfBlock_.resize(blocks_.size());
  trianglesOfBlock_.resize(blocks_.size());
  const auto list = [&](std::vector<std::vector<uint32_t>>& lists, uint32_t item,
                        const CoordBBox& box) {
    const Coord first = (box.min() - low) >> kBlockShift, last = (box.max() - low) >> kBlockShift;
    for (int x = first.x(); x <= last.x(); ++x)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int z = first.z(); z <= last.z(); ++z)
          lists[size_t((x * count.y() + y) * count.z() + z)].push_back(item);
  };
  for (uint32_t i = 0; i < pointCount_; ++i)
    list(pointsOfBlock_, i, reached(points_[i], points_[i]));
  for (uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto& [a, b, c] = triangles_[i];
    using openvdb::math::maxComponent;
    using openvdb::math::minComponent;
    list(trianglesOfBlock_, i,
         reached(minComponent(points_[a], minComponent(points_[b], points_[c])),
                 maxComponent(points_[a], maxComponent(points_[b], points_[c]))));
  }
}

uint32_t MeshDistance::apexBeyond(uint32_t a, uint32_t b) const {
  for (uint32_t i = cornersOfPoint_.first[a]; i < cornersOfPoint_.first[a + 1]; ++i) {
    const uint32_t corner = cornersOfPoint_.items[i];
    const Triangle& triangle = triangles_[corner / 3];
    if (triangle[(corner % 3 + 2) % 3] == b) return triangle[(corner % 3 + 1) % 3];
  }
  return SharedMesh::kNone;
}

std::vector<float> MeshDistance::squaredDistances(size_t block) const {
  BlockDistances distances(blocks_[block], reach_);
  for (const uint32_t point : pointsOfBlock_[block]) distances.addPoint(points_[point]);
  for (const uint32_t number : trianglesOfBlock_[block]) {
    const Triangle& triangle = triangles_[number];
    const std::array<Vec3d, 3> at{points_[triangle[0]], points_[triangle[1]], points_[triangle[2]]};
    distances.addTriangle(at[0], at[1], at[2]);
    const Vec3d normal = normalOf(at[0], at[1], at[2]);
    for (size_t n = 0; n < 3; ++n) {
      const uint32_t a = triangle[n], b = triangle[(n + 1) % 3];
      if (a > b) continue;  // the other triangle's
      const uint32_t apex = apexBeyond(a, b);
      assert(apex != SharedMesh::kNone);
      const Vec3d &from = at[n], &to = at[(n + 1) % 3], beyond(points_[apex]);
      distances.addEdge(from, to, normal, normalOf(to, from, beyond),
                        (beyond - from).dot(normal) < 0);
    }
  }
  return distances.squares();
}

}  // namespace vdb_madf::detail
