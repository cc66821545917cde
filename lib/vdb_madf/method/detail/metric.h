// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cmath>
#include <cstdint>
#include <type_traits>

#include "vdb_madf/method/voxel_weights.h"

// The metric of the method: |v|^2 = wx x^2 + wy y^2 + wz z^2 with the weights of voxel_weights.h,
// exact in integers. All stages take their squares from here. The kernels work along one axis at a
// time and are given its weight; written out in lower_envelope.cc are formulas that expand
// w (u - x)^2.

namespace vdb_madf::detail {

/// The weight of an axis where it is known to be 1 when compiling: kernels for cubes never multiply
/// by it.
using UnitWeight = std::integral_constant<int32_t, 1>;

/// |n e|^2 of a difference of n voxels along an axis with the unit vector e, of that weight.
template <typename T, typename Weight>
constexpr T squaredAlong(T n, Weight weight) {
  return T(weight) * n * n;
}

/// |p - q|^2 of two voxels (Coord).
template <typename Voxel>
int64_t squaredBetween(const Voxel& p, const Voxel& q, const VoxelWeights& weights) {
  int64_t sum = 0;
  for (int axis = 0; axis < 3; ++axis)
    sum += squaredAlong(int64_t(p[axis]) - q[axis], weights[axis]);
  return sum;
}

/// |v + step e|^2 - |v|^2 of a vector v with v e = along: what one step along an axis adds to the
/// distance.
constexpr int32_t addedByStep(int32_t along, int32_t step, int32_t weight) {
  return squaredAlong(along + step, weight) - squaredAlong(along, weight);
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
