// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// The curvature of the interface of two grains, in 1/voxel and 1/voxel^2: mean and standard
/// deviation over the points. The mean curvature is positive where the first grain is convex.
struct InterfaceCurvature {
  int points = 0;  ///< that had enough others around them
  double mean = 0, meanDeviation = 0;
  double gaussian = 0, gaussianDeviation = 0;
  double residual = 0;  ///< root mean square distance of the faces from the fits, voxels
};

}  // namespace vdb_madf
