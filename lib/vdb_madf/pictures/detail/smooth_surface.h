// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The indicator of an object, smoothed: each voxel counts by its distance from a point along each
/// axis, (1 + cos(pi d / 4)) / 8 within 4 voxels. (Standard deviation: 1.45 voxels.) It has a
/// continuous gradient, so that light on it shows no steps of voxels.
class SmoothSurface {
 public:
  using Vec = openvdb::Vec3d;

  SmoothSurface();

  struct Value {
    double fill = 0;  ///< 0..1; 1/2 on a plane
    Vec gradient{0};  ///< per voxel, into the object
  };
  /// @param object without tiles
  /// @param point in voxels; voxel (i, j, k) is the box from there to (i + 1, j + 1, k + 1)
  Value at(const MaskGrid::ConstAccessor& object, const Vec& point) const;

 private:
  static constexpr int kWindow = 8, kSteps = 16;  ///< of the point's place in a voxel, along z
  struct Row {
    float sum = 0, slope = 0;
  };
  std::array<std::array<Row, 256>, kSteps + 1> rows_{};  ///< by the bits of eight voxels along z
};

}  // namespace vdb_madf::detail
