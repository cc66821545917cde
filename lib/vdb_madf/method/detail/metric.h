// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cmath>
#include <cstdint>

// The metric of the method: |v|^2 = x^2 + y^2 + z^2, in voxels squared, exact in integers.
//
// An anisotropic metric, |v|^2 = a x^2 + b y^2 + c z^2 with integer weights, would go here: all
// stages take their squares from squaredAlong(). Those that know the axis would name it; the
// kernels work along one axis at a time and would be given its weight. The bounds that keep squares
// within 32 bits (base/limits.h) and keys within 64 (fits64Bits in power_map.cc) would follow.
// Written for unit weights are the formulas of lower_envelope.cc that expand (u - x)^2.

namespace vdb_madf::detail {

/// |n e|^2 of a difference of n voxels along an axis with the unit vector e.
template <typename T>
constexpr T squaredAlong(T n) {
  return n * n;
}

/// |p - q|^2 of two voxels (Coord).
template <typename Voxel>
int64_t squaredBetween(const Voxel& p, const Voxel& q) {
  int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis) sum += squaredAlong(int64_t(p[axis]) - q[axis]);
  return sum;
}

/// |v + step e|^2 - |v|^2 of a vector v with v e = along: what one step along an axis adds to the
/// distance.
constexpr int32_t addedByStep(int32_t along, int32_t step) {
  return squaredAlong(along + step) - squaredAlong(along);
}

/// Cosine of the angle at which two balls meet (paper, eq. 7), from the squared distance of their
/// centers and their squared radii: 1 where they touch from outside, -1 where one touches the other
/// from inside.
inline double cosAlpha(int64_t squaredDistance, int32_t firstSquaredRadius,
                       int32_t secondSquaredRadius) {
  const double product = double(int64_t(firstSquaredRadius) * secondSquaredRadius);
  return double(squaredDistance - firstSquaredRadius - secondSquaredRadius) /
         (2 * std::sqrt(product));
}

}  // namespace vdb_madf::detail
