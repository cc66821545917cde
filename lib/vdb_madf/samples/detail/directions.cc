// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/directions.h"

#include <algorithm>
#include <cmath>

namespace vdb_madf::detail {

using openvdb::Vec3d;

Vec3d drawDirection(RandomSequence& random) {
  Vec3d v;
  double square;
  do {
    for (int axis = 0; axis < 3; ++axis) v[axis] = random.uniform(-1, 1);
    square = v.dot(v);
  } while (square > 1 || square < 1e-6);
  return v / std::sqrt(square);
}

DirectionMap::DirectionMap(const std::function<double(const Vec3d&)>& function)
    : values_(6 * (kCells + 1) * (kCells + 1)) {
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i <= kCells; ++i)
      for (int j = 0; j <= kCells; ++j) {
        const Vec3d v = place(face, 2.0 * i / kCells - 1, 2.0 * j / kCells - 1);
        values_[offset(face, i, j)] = float(function(v / v.length()));
      }
}

/// A point of the cube from -1 to 1: face 2 a + 1 has coordinate a = 1, face 2 a has -1.
Vec3d DirectionMap::place(int face, double s, double t) {
  Vec3d v;
  const int axis = face / 2;
  v[axis] = face % 2 ? 1 : -1;
  v[(axis + 1) % 3] = s;
  v[(axis + 2) % 3] = t;
  return v;
}

double DirectionMap::value(const Vec3d& v) const {
  int axis = 0;
  for (int other : {1, 2})
    if (std::abs(v[other]) > std::abs(v[axis])) axis = other;
  const double size = std::abs(v[axis]);
  const double s = (v[(axis + 1) % 3] / size + 1) * (kCells / 2.0);
  const double t = (v[(axis + 2) % 3] / size + 1) * (kCells / 2.0);
  const int i = std::min(int(s), kCells - 1), j = std::min(int(t), kCells - 1);
  const double a = s - i, b = t - j;
  const float* const below = &values_[offset(2 * axis + (v[axis] > 0), i, j)];
  const float* const above = below + kCells + 1;
  return (1 - a) * ((1 - b) * below[0] + b * below[1]) + a * ((1 - b) * above[0] + b * above[1]);
}

double DirectionMap::least() const {
  return *std::min_element(values_.begin(), values_.end());
}

double DirectionMap::greatest() const {
  return *std::max_element(values_.begin(), values_.end());
}

double DirectionMap::slope() const {
  double along = 0, across = 0;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i <= kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        const double first = values_[offset(face, i, j + 1)] - double(values_[offset(face, i, j)]);
        const double second = values_[offset(face, j + 1, i)] - double(values_[offset(face, j, i)]);
        along = std::max(along, std::abs(first));
        across = std::max(across, std::abs(second));
      }
  // A direction moves at most three times as far on the cube as on the ball, at a corner.
  return std::sqrt(along * along + across * across) * (kCells / 2.0) * 3;
}

double DirectionMap::volumeOfInverse() const {
  constexpr double kStep = 2.0 / kCells;
  double sum = 0;
  for (int face = 0; face < 6; ++face)
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        const Vec3d v = place(face, (i + 0.5) * kStep - 1, (j + 0.5) * kStep - 1);
        const double inverse = value(v), length = v.length();
        sum += 1 / (inverse * inverse * inverse * length * length * length);
      }
  return sum * kStep * kStep / 3;
}

}  // namespace vdb_madf::detail
