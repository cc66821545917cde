// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/math/Vec3.h>

#include <cstddef>
#include <functional>
#include <vector>

#include "vdb_madf/samples/detail/random.h"

namespace vdb_madf::detail {

/// A unit vector, uniform over all.
openvdb::Vec3d drawDirection(RandomSequence& random);

/// A positive function of the direction, known at the lattice points of the six faces of a cube
/// about the origin, linear along both edges of a face between them.
class DirectionMap {
 public:
  static constexpr int kCells = 24;  ///< along an edge of the cube

  DirectionMap() = default;
  /// @param function of a unit vector
  explicit DirectionMap(const std::function<double(const openvdb::Vec3d&)>& function);

  /// @param v not 0
  double value(const openvdb::Vec3d& v) const;
  double least() const;
  double greatest() const;
  /// Nowhere on the unit ball does the value change faster along the surface.
  double slope() const;
  /// The volume of the body that reaches 1 / value in each direction.
  double volumeOfInverse() const;

 private:
  static openvdb::Vec3d place(int face, double s, double t);
  size_t offset(int face, int i, int j) const {
    return (size_t(face) * (kCells + 1) + size_t(i)) * (kCells + 1) + size_t(j);
  }

  std::vector<float> values_;
};

}  // namespace vdb_madf::detail
