// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Types.h>

namespace vdb_madf {

/// Grains with a gap of no more voxels touch: by so much gaps are uncertain.
constexpr double kContactGap = 0.3;

/// The neck of a bond as the gray scan shows it, freed of the scan's blur; in voxels. Area, radius
/// and gap are NaN where the scan does not tell them.
struct Neck {
  double area = 0;        ///< of the narrowest plane section; 0: the scan shows a gap
  double radius = 0;      ///< of the disc of this area
  double error = 0;       ///< standard error of the area
  double gap = 0;         ///< between the grains, where there is no neck
  openvdb::Vec3d normal;  ///< unit vector from the first to the second grain
  /// The area is larger than what noise and blur make of two grains that do not touch.
  bool confirmed = false;

  /// Not where there is a gap; where nothing is known the labels are believed.
  bool touches() const { return !(gap > kContactGap); }
};

}  // namespace vdb_madf
