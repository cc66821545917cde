// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The mean squared distance from some planes, each with a weight (Garland and Heckbert 1997).
class Quadric {
 public:
  /// \p normal: of length 1
  void addPlane(const openvdb::Vec3d& point, const openvdb::Vec3d& normal, double weight) {
    const double d = -normal.dot(point);
    for (int i = 0, n = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) square_[n++] += weight * normal[i] * normal[j];
      linear_[i] += weight * d * normal[i];
    }
    constant_ += weight * d * d;
    weight_ += weight;
  }

  Quadric& operator+=(const Quadric& other) {
    for (int n = 0; n < 6; ++n) square_[n] += other.square_[n];
    linear_ += other.linear_;
    constant_ += other.constant_;
    weight_ += other.weight_;
    return *this;
  }

  double at(const openvdb::Vec3d& p) const {
    if (!(weight_ > 0)) return 0;
    const double* s = square_;
    const openvdb::Vec3d product(s[0] * p.x() + s[1] * p.y() + s[2] * p.z(),
                                 s[1] * p.x() + s[3] * p.y() + s[4] * p.z(),
                                 s[2] * p.x() + s[4] * p.y() + s[5] * p.z());
    return std::max(0.0, (p.dot(product) + 2 * p.dot(linear_) + constant_) / weight_);
  }

 private:
  double square_[6] = {};  ///< xx, xy, xz, yy, yz, zz
  openvdb::Vec3d linear_{0};
  double constant_ = 0, weight_ = 0;
};

}  // namespace vdb_madf::detail
