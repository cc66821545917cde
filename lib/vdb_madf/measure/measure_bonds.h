// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/crossing.h"
#include "vdb_madf/measure/gray_values.h"
#include "vdb_madf/measure/interface_curvature.h"
#include "vdb_madf/measure/neck.h"
#include "vdb_madf/measure/recurrence.h"

namespace vdb_madf {

/// Two grains that share at least one voxel face; lengths in voxels, of unequal ones in their
/// shortest edge (Measurements::edges).
struct BondMeasures {
  int32_t first = 0, second = 0;  ///< labels, first < second
  int64_t faces = 0;              ///< voxel faces between them
  double faceArea = 0;            ///< of these, = faces, of cubes: overestimates the area
  /// Area of the interface, estimated; README.md beside this says how.
  double area = 0;
  double equivalentRadius = 0;  ///< of the disc of this area
  openvdb::Vec3d centroid;      ///< mean of the centers of the faces, index coordinates
  /// Unit vector from the first to the second grain: direction of the sum of the faces' area
  /// vectors. If they cancel (one grain encloses the other), the direction of least extent.
  openvdb::Vec3d normal;
  double flatness = 0;  ///< smallest eigenvalue of the covariance of the faces' centers
  int patches = 0;      ///< parts of the interface, faces with a common corner being one
  /// None of an interface of fewer than 10 faces, or of faces in a row.
  std::optional<InterfaceCurvature> curvature;
  /// Distance of the representatives c of the grains, with squared inscribed radii D, and
  /// cos alpha = (|c1 - c2|^2 - D1 - D2) / (2 sqrt(D1 D2)). None without background.
  std::optional<double> distance, cosAlpha;
  /// The largest ball within both grains' object that is centered beside the interface: of its
  /// voxel faces the largest of the smaller distances of the two voxels to the background. None
  /// unless it was asked for, and without background.
  std::optional<double> inscribedRadius;
  /// Gray values at the voxels on both sides, those of either grain with a face towards the other,
  /// each once. None unless it was asked for.
  std::optional<GrayValues> gray;
  std::optional<Neck> neck;              ///< of the gray scan; none unless it was asked for
  std::optional<Recurrence> recurrence;  ///< likewise, when the scan was segmented by other choices
  std::optional<BondCrossing> crossing;  ///< none unless it was asked for
  /// The largest strictness at which the two grains are one; none: nowhere, or not asked for.
  std::optional<double> vanishes;
};

}  // namespace vdb_madf
