// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// How a scan shows the grains of labels.
struct GrainsInScan {
  /// The part of the grains' voxels that is brighter than the scan's middle gray, less that of the
  /// voxels around them; absent if there are none of the one or of the other.
  std::optional<double> brighter;
  /// About how far the scan shows the grains from where the labels have them, voxels, along each
  /// axis that enough faces tell of: of labels of this scan the mean of two voxels at a face of a
  /// grain is the same on both sides of it; in a shifted scan it is larger on one, by the shift
  /// times the slope. A shift of a voxel comes out as 0.8 to 1.6 of one.
  openvdb::Vec3d shift{0, 0, 0};
};

/// By the voxels that are in the leaf nodes of `gray`, finite, and within a box.
GrainsInScan grainsInScan(const Int32Tree& labels, const FloatGrid::TreeType& gray,
                          const CoordBBox& known, double middle);

}  // namespace vdb_madf::detail
