// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/math/Vec3.h>

namespace vdb_madf {

/// The neck of a bond as the gray scan shows it, freed of the scan's blur; in voxels.
struct Neck {
  double area = 0;        ///< of the narrowest plane section; 0: the scan shows a gap
  double radius = 0;      ///< of the disc of this area
  double error = 0;       ///< standard error of the area
  openvdb::Vec3d normal;  ///< unit vector from the first to the second grain
  /// The area is larger than what noise and blur make of two grains that do not touch.
  bool confirmed = false;
};

}  // namespace vdb_madf
