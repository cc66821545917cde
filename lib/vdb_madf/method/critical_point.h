// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// A fixed point c of the flow p -> Pi(p), with its stable manifold: the voxels that flow to it.
struct CriticalPoint {
  Coord position;
  int32_t squaredRadius = 0;  ///< D(c)
  int64_t voxels = 0;         ///< of its stable manifold, in the object
  int64_t cavityVoxels = 0;   ///< of its stable manifold, in cavities that were filled
  /// What of D(c) is not sure: all of it if the ball of c reaches out of the domain, where nothing
  /// is known, else 0 (placeGraph()). Of a class (slabs): its largest D less the largest sure one.
  int32_t doubt = 0;
  bool operator==(const CriticalPoint& o) const {
    return position == o.position && squaredRadius == o.squaredRadius && voxels == o.voxels &&
           cavityVoxels == o.cavityVoxels && doubt == o.doubt;
  }
  /// One of its voxels lies in a cavity.
  void leaveToCavity() {
    --voxels;
    ++cavityVoxels;
  }
};

}  // namespace vdb_madf
