// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/smooth_surface.h"

#include <array>
#include <cmath>

namespace vdb_madf::detail {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;
constexpr int kWindow = 8;  // voxels along each axis that count

/// What the voxels of the window count along an axis, and how that changes as the point moves.
struct Weights {
  std::array<double, kWindow> value{}, slope{};

  /// @param part of a voxel that the point is beyond the center of voxel 3 of the window
  explicit Weights(double part) {
    const double c = std::cos(M_PI / 4 * part), s = std::sin(M_PI / 4 * part);
    const double r = std::sqrt(0.5);
    // Cosine and sine of pi/4 (k - 3).
    const double cosines[kWindow] = {-r, 0, r, 1, r, 0, -r, -1};
    const double sines[kWindow] = {-r, -1, -r, 0, r, 1, r, 0};
    for (size_t k = 0; k < kWindow; ++k) {
      value[k] = (1 + cosines[k] * c + sines[k] * s) / 8;
      slope[k] = M_PI / 32 * (sines[k] * c - cosines[k] * s);
    }
  }
};

/// Sums over the voxels that four bits name.
using Sums = std::array<double, 16>;

Sums sumsOf(const std::array<double, kWindow>& weights, size_t first) {
  Sums sums{};
  for (size_t bits = 1; bits < sums.size(); ++bits) {
    const auto lowest = size_t(__builtin_ctz(unsigned(bits)));
    sums[bits] = sums[bits & (bits - 1)] + weights[first + lowest];
  }
  return sums;
}

/// Eight voxels of a leaf along z.
unsigned zRow(const MaskLeaf* leaf, int x, int y) {
  return leaf
             ? unsigned(leaf->getValueMask().getWord<uint64_t>(openvdb::Index(x)) >> (8 * y)) & 255u
             : 0u;
}

}  // namespace

SmoothValue smoothValue(const MaskGrid::ConstAccessor& object, const openvdb::Vec3d& point) {
  Coord low;  // of the window
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double below = std::floor(point[axis] - 0.5);
    low[axis] = int(below) - 3;
    part[axis] = point[axis] - 0.5 - below;
  }
  const Coord firstLeaf(low.x() & ~7, low.y() & ~7, low.z() & ~7);
  const MaskLeaf* leaves[2][2][2];  // the window meets two along an axis
  for (int i = 0; i < 8; ++i)
    leaves[i >> 2][i >> 1 & 1][i & 1] =
        object.probeConstLeaf(firstLeaf + Coord(8 * (i >> 2), 8 * (i >> 1 & 1), 8 * (i & 1)));

  const Weights alongX(part[0]), alongY(part[1]), alongZ(part[2]);
  const Sums values[2] = {sumsOf(alongZ.value, 0), sumsOf(alongZ.value, 4)};
  const Sums slopes[2] = {sumsOf(alongZ.slope, 0), sumsOf(alongZ.slope, 4)};
  const int shift = low.z() - firstLeaf.z();
  SmoothValue result;
  for (size_t i = 0; i < kWindow; ++i) {
    const int x = low.x() + int(i) - firstLeaf.x();
    double sum = 0, dy = 0, dz = 0;
    for (size_t j = 0; j < kWindow; ++j) {
      const int y = low.y() + int(j) - firstLeaf.y();
      const auto& leafRow = leaves[x >> 3][y >> 3];
      const unsigned bits =
          (zRow(leafRow[0], x & 7, y & 7) | zRow(leafRow[1], x & 7, y & 7) << 8) >> shift & 255;
      if (bits == 0) continue;
      const double value = values[0][bits & 15] + values[1][bits >> 4];
      sum += alongY.value[j] * value;
      dy += alongY.slope[j] * value;
      dz += alongY.value[j] * (slopes[0][bits & 15] + slopes[1][bits >> 4]);
    }
    result.fill += alongX.value[i] * sum;
    result.gradient +=
        openvdb::Vec3d(alongX.slope[i] * sum, alongX.value[i] * dy, alongX.value[i] * dz);
  }
  return result;
}

}  // namespace vdb_madf::detail
