// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

#include <cmath>
#include <optional>

namespace vdb_madf::detail {

using openvdb::Mat3d;
using openvdb::Vec3d;

/// a b^T
inline Mat3d outer(const Vec3d& a, const Vec3d& b) {
  return {a[0] * b[0], a[0] * b[1], a[0] * b[2], a[1] * b[0], a[1] * b[1],
          a[1] * b[2], a[2] * b[0], a[2] * b[1], a[2] * b[2]};
}

inline double squaredNorm(const Mat3d& m) {
  double sum = 0;
  for (int i = 0; i < 9; ++i) sum += m.asPointer()[i] * m.asPointer()[i];
  return sum;
}

inline double trace(const Mat3d& m) {
  return m(0, 0) + m(1, 1) + m(2, 2);
}

/// The inverse of a matrix of positive determinant, that is not close to 0 for its size.
inline std::optional<Mat3d> inverseOf(const Mat3d& m) {
  const double size = std::sqrt(squaredNorm(m) / 3);
  if (!(m.det() > 1e-6 * size * size * size)) return std::nullopt;
  return m.inverse(0);
}

/// The turn R of the polar decomposition F = R U, by Newton's iteration; the identity of what has
/// none.
inline Mat3d turnOf(Mat3d f) {
  for (int round = 0; round < 40; ++round) {
    const auto inverse = inverseOf(f);
    if (!inverse) return Mat3d::identity();
    const Mat3d next = (f + inverse->transpose()) * 0.5;
    const double change = squaredNorm(next - f);
    f = next;
    if (change < 1e-28) break;
  }
  return f;
}

/// Least squares of y = F x + t over pairs of points, F near a given one.
class LocalFit {
 public:
  void add(const Vec3d& x, const Vec3d& y) {
    if (count_++ == 0) {
      x0_ = x;
      y0_ = y;
    }
    const Vec3d dx = x - x0_, dy = y - y0_;
    sumX_ += dx;
    sumY_ += dy;
    xx_ += outer(dx, dx);
    yx_ += outer(dy, dx);
  }
  int count() const { return count_; }
  Vec3d meanX() const { return x0_ + sumX_ / count_; }
  Vec3d meanY() const { return y0_ + sumY_ / count_; }

  /// @param weight of `near`, in squared lengths of x; 0: none
  std::optional<Mat3d> gradient(const Mat3d& near, double weight) const {
    const Mat3d xx = xx_ - outer(sumX_, sumX_) * (1. / count_) + Mat3d::identity() * weight,
                yx = yx_ - outer(sumY_, sumX_) * (1. / count_) + near * weight;
    const auto inverse = inverseOf(xx);
    if (!inverse) return std::nullopt;
    return yx * *inverse;
  }

 private:
  int count_ = 0;
  Vec3d x0_{0, 0, 0}, y0_{0, 0, 0}, sumX_{0, 0, 0}, sumY_{0, 0, 0};
  Mat3d xx_ = Mat3d::zero(), yx_ = Mat3d::zero();
};

}  // namespace vdb_madf::detail
