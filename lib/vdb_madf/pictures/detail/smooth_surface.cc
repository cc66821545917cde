// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/smooth_surface.h"

#include <cmath>

namespace vdb_madf::detail {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;

double weight(double distance) {
  return (1 + std::cos(M_PI / 4 * distance)) / 8;
}

/// Of the weight, as the point moves.
double slope(double distance) {
  return M_PI / 32 * std::sin(M_PI / 4 * distance);
}

/// Eight voxels of a leaf along z.
unsigned zRow(const MaskLeaf* leaf, int x, int y) {
  return leaf
             ? unsigned(leaf->getValueMask().getWord<uint64_t>(openvdb::Index(x)) >> (8 * y)) & 255u
             : 0u;
}

}  // namespace

SmoothSurface::SmoothSurface() {
  for (int step = 0; step <= kSteps; ++step)
    for (unsigned bits = 0; bits < 256; ++bits)
      for (int k = 0; k < kWindow; ++k) {
        if (!(bits >> k & 1)) continue;
        const double distance = k - 3 - double(step) / kSteps;
        rows_[size_t(step)][bits].sum += float(weight(distance));
        rows_[size_t(step)][bits].slope += float(slope(distance));
      }
}

SmoothSurface::Value SmoothSurface::at(const MaskGrid::ConstAccessor& object,
                                       const Vec& point) const {
  Coord low;  // of the eight voxels along each axis
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

  double weightY[kWindow], slopeY[kWindow];
  for (int k = 0; k < kWindow; ++k) {
    weightY[k] = weight(k - 3 - part[1]);
    slopeY[k] = slope(k - 3 - part[1]);
  }
  const auto& rows = rows_[size_t(std::lround(part[2] * kSteps))];
  const int shift = low.z() - firstLeaf.z();
  Value value;
  for (int i = 0; i < kWindow; ++i) {
    const int x = low.x() + i - firstLeaf.x();
    double sum = 0, alongY = 0, alongZ = 0;
    for (int j = 0; j < kWindow; ++j) {
      const int y = low.y() + j - firstLeaf.y();
      const auto& along = leaves[x >> 3][y >> 3];
      const unsigned bits = zRow(along[0], x & 7, y & 7) | zRow(along[1], x & 7, y & 7) << 8;
      const Row& row = rows[bits >> shift & 255];
      sum += weightY[j] * double(row.sum);
      alongY += slopeY[j] * double(row.sum);
      alongZ += weightY[j] * double(row.slope);
    }
    const double weightX = weight(i - 3 - part[0]);
    value.fill += weightX * sum;
    value.gradient += Vec(slope(i - 3 - part[0]) * sum, weightX * alongY, weightX * alongZ);
  }
  return value;
}

}  // namespace vdb_madf::detail
