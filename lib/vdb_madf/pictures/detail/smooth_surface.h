// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The indicator of an object, smoothed: each voxel counts by its distance from a point along each
/// axis, (1 + cos(pi d / 4)) / 8 within 4 voxels. (Standard deviation: 1.45 voxels.) It has a
/// continuous gradient, so that light on it shows no steps of voxels.
struct SmoothValue {
  double fill = 0;             ///< 0..1; 1/2 on a plane
  openvdb::Vec3d gradient{0};  ///< per voxel, into the object
};

/// Reads it off an object, and remembers the last 8 x 8 x 8 voxels: for one thread, and points that
/// lie close to each other.
class SmoothSurface {
 public:
  /// @param object without tiles; is kept by reference
  explicit SmoothSurface(const MaskGrid& object) : object_(object.getConstUnsafeAccessor()) {}

  /// @param point in voxels; voxel (i, j, k) is the box from there to (i + 1, j + 1, k + 1)
  SmoothValue at(const openvdb::Vec3d& point);

 private:
  void moveTo(const Coord& low);

  const MaskGrid::ConstUnsafeAccessor object_;
  Coord low_{0};           ///< of the voxels that are remembered
  bool isFilled_ = false;  ///< are there any?
  /// The rows of them along z, by x, then y: the lower four voxels and the upper ones as bits,
  /// times 16.
  std::array<uint8_t, 64> nearer_{}, farther_{};
};

}  // namespace vdb_madf::detail
