// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/shapes/detail/block_distances.h"

#include <cmath>
#include <type_traits>
#include <utility>

#include "vdb_madf/shapes/detail/whole_places.h"

namespace vdb_madf::detail {

namespace {

using openvdb::Vec3d;
using openvdb::Vec3f;

/// Voxels: so much farther than it could be, voxels are measured to a feature.
constexpr double kSlack = 1e-4;
/// Voxels so far beside a triangle, in parts of its height, still count as above it.
constexpr double kBeside = 1e-6;
/// Triangles that turn by less (1 - cosine) have no wedge between them: their slack fills it.
constexpr double kFlat = 1e-14;
/// Wedges of a smaller cosine are searched in the whole reach around their edges, those with
/// normals along the axis of less than kLeastSlope in a box.
constexpr double kWide = -0.9, kLeastSlope = 0.2;

int longest(const Vec3d& v) {
  const double x = std::abs(v[0]), y = std::abs(v[1]), z = std::abs(v[2]);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

/// f(axis), a constant when compiling.
template <typename F>
void withAxis(int axis, const F& f) {
  if (axis == 0)
    f(std::integral_constant<int, 0>());
  else if (axis == 1)
    f(std::integral_constant<int, 1>());
  else
    f(std::integral_constant<int, 2>());
}

}  // namespace

BlockDistances::BlockDistances(const CoordBBox& box, float reach)
    : box_(box),
      reach_(reach),
      steps_(int(std::ceil(reach))),
      width_((2 * steps_ + 2 + 7) / 8 * 8),
      beside_(width_),
      rowLength_(box.dim().z() + 2 * beside_),
      layerLength_(box.dim().y() * rowLength_),
      squares_(size_t(box.dim().x()) * size_t(box.dim().y()) * size_t(rowLength_), reach * reach) {}

void BlockDistances::addPoint(const Vec3f& point) {
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

std::array<BlockDistances::Range, 3> BlockDistances::boxOfWedge(const Vec3d& a, const Vec3d& b,
                                                                const Vec3d& step,
                                                                const Vec3d& otherStep) const {
  std::array<Range, 3> box;
  for (int i = 0; i < 3; ++i)
    box[size_t(i)] = {
        std::min(a[i], b[i]) + std::clamp(std::min(step[i], otherStep[i]), -reach_, 0.0),
        std::max(a[i], b[i]) + std::clamp(std::max(step[i], otherStep[i]), 0.0, reach_)};
  return box;
}

template <int kW, typename RectangleOf, typename F>
void BlockDistances::forEachIn(const Range& heights, const RectangleOf& rectangleOf, const F& f) {
  constexpr int kU = (kW + 1) % 3, kV = (kW + 2) % 3;
  const Coord low = box_.min(), high = box_.max();
  const int lastW = std::min(floorOf(heights.high + kSlack), high[kW]);
  std::array<std::array<int, 5>, kMaxSide + 1> slices;
  size_t count = 0;
  for (int w = std::max(ceilOf(heights.low - kSlack), low[kW]); w <= lastW; ++w) {
    const auto [alongU, alongV] = rectangleOf(double(w));
    const int firstU = std::max(ceilOf(alongU.low - kSlack), low[kU]),
              lastU = std::min(floorOf(alongU.high + kSlack), high[kU]),
              firstV = std::max(ceilOf(alongV.low - kSlack), low[kV]),
              lastV = std::min(floorOf(alongV.high + kSlack), high[kV]);
    slices[count] = {w, firstU, lastU, firstV, lastV};
    // Most are empty, which no branch could foresee.
    count += size_t(firstU <= lastU) & size_t(firstV <= lastV);
  }
  for (size_t i = 0; i < count; ++i) {
    const auto& [w, firstU, lastU, firstV, lastV] = slices[i];
    for (int u = firstU; u <= lastU; ++u)
      for (int v = firstV; v <= lastV; ++v) {
        Coord p;
        p[kW] = w;
        p[kU] = u;
        p[kV] = v;
        f(double(w), double(u), double(v), squares_[place(p.x(), p.y(), p.z())]);
      }
  }
}

void BlockDistances::addTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, normal = ab.cross(ac);
  const double area = normal.lengthSqr();  // of the parallelogram, squared
  if (area == 0) return;
  withAxis(longest(normal), [&](auto axis) {
    constexpr int kW = axis, kU = (kW + 1) % 3, kV = (kW + 2) % 3;
    const double down = 1 / normal[kW], slopeU = normal[kU] * down, slopeV = normal[kV] * down,
                 height = reach_ * std::abs(normal[kW]) / std::sqrt(area);
    Range alongU{kFar, -kFar}, alongV = alongU, heights = alongU;  // where w is 0
    for (const Vec3d* corner : {&a, &b, &c}) {
      const Vec3d& p = *corner;
      alongU.include(p[kU] - p[kW] * slopeU);
      alongV.include(p[kV] - p[kW] * slopeV);
      heights.include(p[kW]);
    }
    // Products with these are the area times the weights of b and c.
    const double bb = ab.lengthSqr(), cc = ac.lengthSqr(), bc = ab.dot(ac);
    const Vec3d toB = cc * ab - bc * ac, toC = bb * ac - bc * ab;
    const double least = -kBeside * area, most = area - 2 * least, scale = 1 / area;
    forEachIn<kW>(
        {heights.low - height, heights.high + height},
        [&](double w) {
          return std::pair(Range{alongU.low + w * slopeU, alongU.high + w * slopeU},
                           Range{alongV.low + w * slopeV, alongV.high + w * slopeV});
        },
        [&](double w, double u, double v, float& square) {
          const double dw = w - a[kW], du = u - a[kU], dv = v - a[kV],
                       weightB = toB[kW] * dw + toB[kU] * du + toB[kV] * dv,
                       weightC = toC[kW] * dw + toC[kU] * du + toC[kV] * dv;
          if (weightB < least || weightC < least || weightB + weightC > most) return;
          const double up = normal[kW] * dw + normal[kU] * du + normal[kV] * dv;
          square = std::min(square, float(up * up * scale));
        });
  });
}

void BlockDistances::addEdge(const Vec3d& a, const Vec3d& b, Vec3d one, Vec3d other) {
  const double cosine = one.dot(other);
  const Vec3d edge = b - a;
  if (cosine > 1 - kFlat || edge == Vec3d(0)) return;
  if (one.cross(other).dot(edge) < 0) {  // the second bends towards the normal of the first
    one = -one;
    other = -other;
  }
  const bool isWide = cosine < kWide || one == Vec3d(0) || other == Vec3d(0);
  const std::array<Range, 3> box =
      isWide ? boxOfWedge(a, b, Vec3d(-reach_), Vec3d(reach_))
             // What is within reach is a sum of the normals whose weights are at most this one.
             : boxOfWedge(a, b, one * (reach_ * std::sqrt(2 / (1 + cosine))),
                          other * (reach_ * std::sqrt(2 / (1 + cosine))));
  const double scale = 1 / edge.lengthSqr();
  withAxis(longest(one + other), [&](auto axis) {
    constexpr int kW = axis, kU = (kW + 1) % 3, kV = (kW + 2) % 3;
    const double sign = one[kW] + other[kW] < 0 ? -1 : 1;
    const bool isBox = isWide || std::min(sign * one[kW], sign * other[kW]) < kLeastSlope;
    const double down = isBox ? 0 : 1 / one[kW], otherDown = isBox ? 0 : 1 / other[kW];
    // In a slice across the axis the wedge is what lies between the normals from both ends.
    const auto across = [&](double w, int side) {
      const Range& range = box[size_t(side)];
      if (isBox) return range;
      const double slope = one[side] * down, otherSlope = other[side] * otherDown, up = w - a[kW],
                   upB = w - b[kW];
      Range lines{a[side] + up * slope, a[side] + up * slope};
      lines.include(a[side] + up * otherSlope);
      lines.include(b[side] + upB * slope);
      lines.include(b[side] + upB * otherSlope);
      return Range{std::max(range.low, lines.low), std::min(range.high, lines.high)};
    };
    forEachIn<kW>(
        box[size_t(kW)], [&](double w) { return std::pair(across(w, kU), across(w, kV)); },
        [&](double w, double u, double v, float& square) {
          const double dw = w - a[kW], du = u - a[kU], dv = v - a[kV],
                       atLine = (edge[kW] * dw + edge[kU] * du + edge[kV] * dv) * scale,
                       along = std::min(std::max(atLine, 0.0), 1.0);
          const double x = dw - along * edge[kW], y = du - along * edge[kU],
                       z = dv - along * edge[kV];
          square = std::min(square, float(x * x + y * y + z * z));
        });
  });
}

std::vector<float> BlockDistances::squares() const {
  std::vector<float> result;
  result.reserve(size_t(box_.volume()));
  for (int x = box_.min().x(); x <= box_.max().x(); ++x)
    for (int y = box_.min().y(); y <= box_.max().y(); ++y) {
      const float* row = &squares_[place(x, y, box_.min().z())];
      result.insert(result.end(), row, row + box_.dim().z());
    }
  return result;
}

}  // namespace vdb_madf::detail
