// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

namespace vdb_madf {

/// The voxels that have one index along an axis.
struct SlicePlane {
  int axis = 2;   ///< 0: x, 1: y, 2: z
  int index = 0;  ///< of the voxels, along that axis

  /// The other axes, in the order of x, y, z.
  int right() const { return axis == 0 ? 1 : 0; }
  int down() const { return axis == 2 ? 1 : 2; }
};

/// What the voxels of a plane show, from dark to bright: rows along its axis right(), one after the
/// other along down(), in ascending order of the indices.
struct GrayPlane {
  int width = 0, height = 0;
  std::vector<uint8_t> values;
};

}  // namespace vdb_madf
