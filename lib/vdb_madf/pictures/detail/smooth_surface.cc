// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/smooth_surface.h"

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace vdb_madf::detail {

namespace {

using MaskLeaf = MaskTree::LeafNodeType;
constexpr int kWindow = 8;  // voxels along each axis that count

/// A value and its slope, side by side: what is done to one is done to the other.
using Pair = double __attribute__((vector_size(16)));

/// What the voxels of the window count along an axis, and how that changes as the point moves.
struct Weights {
  std::array<Pair, kWindow> of{};

  /// @param part of a voxel that the point is beyond the center of voxel 3 of the window
  explicit Weights(double part) {
    const double c = std::cos(M_PI / 4 * part), s = std::sin(M_PI / 4 * part);
    const double r = std::sqrt(0.5);
    // Cosine and sine of pi/4 (k - 3).
    const double cosines[kWindow] = {-r, 0, r, 1, r, 0, -r, -1};
    const double sines[kWindow] = {-r, -1, -r, 0, r, 1, r, 0};
    for (size_t k = 0; k < kWindow; ++k)
      of[k] = Pair{(1 + cosines[k] * c + sines[k] * s) / 8,
                   M_PI / 32 * (sines[k] * c - cosines[k] * s)};
  }
};

/// Sums over the voxels that four bits name.
using Sums = std::array<Pair, 16>;

Sums sumsOf(const Weights& weights, size_t first) {
  Sums sums{};
  for (size_t bits = 1; bits < sums.size(); ++bits) {
    const auto lowest = size_t(__builtin_ctz(unsigned(bits)));
    sums[bits] = sums[bits & (bits - 1)] + weights.of[first + lowest];
  }
  return sums;
}

/// The sum whose place is given in bytes, so that looking it up takes one instruction.
Pair sumAt(const Sums& sums, uint8_t byte) {
  return *reinterpret_cast<const Pair*>(reinterpret_cast<const char*>(sums.data()) + byte);
}

/// The word of a leaf with its voxels of one x.
uint64_t wordOf(const MaskLeaf* leaf, int x) {
  return leaf ? leaf->getValueMask().getWord<uint64_t>(openvdb::Index(x)) : 0;
}

/// Eight rows of z, from `shift` (0..7) on in `first`, then in `second`.
uint64_t rowsFrom(uint64_t first, uint64_t second, int shift) {
  const uint64_t kept = 0x0101010101010101u * (0xffu >> shift);
  return (first >> shift & kept) | (second << (8 - shift) & ~kept);
}

}  // namespace

void SmoothSurface::moveTo(const Coord& low) {
  if (isFilled_ && low == low_) return;
  const Coord firstLeaf(low.x() & ~7, low.y() & ~7, low.z() & ~7);
  const MaskLeaf* leaves[2][2][2];  // the window meets two along an axis
  for (int i = 0; i < 8; ++i)
    leaves[i >> 2][i >> 1 & 1][i & 1] =
        object_.probeConstLeaf(firstLeaf + Coord(8 * (i >> 2), 8 * (i >> 1 & 1), 8 * (i & 1)));
  const Coord shift = low - firstLeaf;
  for (int i = 0; i < kWindow; ++i) {
    const int x = shift.x() + i;
    const auto& leaf = leaves[x >> 3];
    const uint64_t nearer =
        rowsFrom(wordOf(leaf[0][0], x & 7), wordOf(leaf[0][1], x & 7), shift.z());
    const uint64_t farther =
        rowsFrom(wordOf(leaf[1][0], x & 7), wordOf(leaf[1][1], x & 7), shift.z());
    const uint64_t plane =
        shift.y() == 0 ? nearer : nearer >> 8 * shift.y() | farther << (64 - 8 * shift.y());
    const uint64_t high = 0xf0f0f0f0f0f0f0f0u, places[2] = {plane << 4 & high, plane & high};
    std::memcpy(&nearer_[size_t(8 * i)], &places[0], 8);
    std::memcpy(&farther_[size_t(8 * i)], &places[1], 8);
  }
  low_ = low;
  isFilled_ = true;
}

SmoothValue SmoothSurface::at(const openvdb::Vec3d& point) {
  Coord low;  // of the window
  double part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double below = std::floor(point[axis] - 0.5);
    low[axis] = int(below) - 3;
    part[axis] = point[axis] - 0.5 - below;
  }
  moveTo(low);
  const Weights alongX(part[0]), alongY(part[1]), alongZ(part[2]);
  const Sums nearer = sumsOf(alongZ, 0), farther = sumsOf(alongZ, 4);
  SmoothValue result;
  for (size_t i = 0; i < kWindow; ++i) {
    Pair valued{}, sloped{};  // by the value and by the slope along y
    for (size_t j = 0; j < kWindow; ++j) {
      const Pair row = sumAt(nearer, nearer_[8 * i + j]) + sumAt(farther, farther_[8 * i + j]);
      valued += alongY.of[j][0] * row;
      sloped += alongY.of[j][1] * row;
    }
    const auto [value, slope] = std::pair(alongX.of[i][0], alongX.of[i][1]);
    result.fill += value * valued[0];
    result.gradient += openvdb::Vec3d(slope * valued[0], value * sloped[0], value * valued[1]);
  }
  return result;
}

}  // namespace vdb_madf::detail
