// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

namespace vdb_madf {

/// How a scan shows an edge between two materials.
struct ScanBlur {
  double inside = 0, outside = 0;  ///< mean gray values of the object and of what is around it
  /// Standard deviation of the gray values far from edges, as a share of the contrast
  /// (inside - outside).
  double noise = 0;
  /// Standard deviation of the point spread along an axis, in voxels, with the voxel itself: a
  /// perfect scanner has sqrt(1/12) = 0.29.
  double sigma = 0;
  /// The part of the values that are the least, or the largest, if that is more: much of a scan
  /// that was cut off, whose blur and noise are larger than these.
  double atEnds = 0;
  /// The larger standard deviation of the gray values far from edges, inside or outside, over the
  /// smaller: large where either is of two materials.
  double unlike = 1;
};

}  // namespace vdb_madf
