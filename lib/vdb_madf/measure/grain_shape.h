// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

namespace vdb_madf {

/// The convex hull of a grain whose voxels are boxes; lengths in voxels, of unequal ones in their
/// shortest edge (Measurements::edges). A single voxel has a hull, too: itself.
struct GrainShape {
  /// The largest distance of two points of the hull.
  double maxFeret = 0;
  /// The smallest distance of two parallel planes with the hull between them, of any direction.
  double minFeret = 0;
  double convexVolume = 0;
  /// Diameter of the disc whose area is the mean of the hull's projections in all directions: a
  /// quarter of its surface (Cauchy).
  double projectedDiameter = 0;
};

/// The class of a body by its axes a >= b >= c > 0 after Zingg (1935, Beitrag zur
/// Schotteranalyse): 1 disc (b/a above 2/3, c/b not), 2 equant (both above 2/3), 3 blade (neither),
/// 4 rod (c/b alone).
int zinggClass(const std::array<double, 3>& axes);

}  // namespace vdb_madf
