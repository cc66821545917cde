// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf {

/// Edge of a cubic voxel and the unit that the transform of a grid is written in.
///
/// OpenVDB refuses transforms with a voxel volume below 3e-15, so metres do not work for micro-CT:
/// grids are written in millimetres (below 20 nm: micrometres), the SI size stands in metadata.
struct VoxelSize {
  double metres = 0;  ///< > 0

  /// "mm", or "um" below 20 nm.
  std::string unit() const;
  /// Edge in unit().
  double inUnit() const;
};

}  // namespace vdb_madf
