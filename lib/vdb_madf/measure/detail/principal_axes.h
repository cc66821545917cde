// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "vdb_madf/measure/detail/voxel_shape.h"
#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf::detail {

/// Eigenvectors and eigenvalues of a symmetric tensor: xx, yy, zz, xy, xz, yz.
inline Principal principalAxes(const std::array<double, 6>& t) {
  Eigen::Matrix3d matrix;
  matrix << t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  Principal result;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d axis = solver.eigenvectors().col(2 - i);
    int largest = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(axis[k]) > std::abs(axis[largest]) + 1e-9) largest = k;
    if (axis[largest] < 0) axis = -axis;
    result.axes[size_t(i)] = {axis[0], axis[1], axis[2]};
    result.values[size_t(i)] = solver.eigenvalues()[2 - i];
  }
  return result;
}

/// Covariance of n points from their exact sums and sums of products (xx, yy, zz, xy, xz, yz).
inline std::array<double, 6> covariance(int64_t n, const std::array<int64_t, 3>& sum,
                                        const std::array<int64_t, 6>& products) {
  // The difference of two large integers: exact before it becomes a double.
  using Wide = __int128;
  const auto of = [&](int64_t product, int64_t a, int64_t b) {
    return double(Wide(n) * product - Wide(a) * b) / (double(n) * double(n));
  };
  return {of(products[0], sum[0], sum[0]), of(products[1], sum[1], sum[1]),
          of(products[2], sum[2], sum[2]), of(products[3], sum[0], sum[1]),
          of(products[4], sum[0], sum[2]), of(products[5], sum[1], sum[2])};
}

/// Makes a covariance of places in voxels one of places in space.
inline void inSpace(const VoxelShape& voxel, std::array<double, 6>& tensor) {
  const openvdb::Vec3d& e = voxel.edges;
  const double factors[6] = {e[0] * e[0], e[1] * e[1], e[2] * e[2],
                             e[0] * e[1], e[0] * e[2], e[1] * e[2]};
  for (size_t i = 0; i < 6; ++i) tensor[i] *= factors[i];
}

}  // namespace vdb_madf::detail
