// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <tuple>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The best ball of a connected component of the object, for the filter by gamma: a component all
/// of whose balls are too small keeps it.
struct ComponentBall {
  /// Kinds go from worse to better. `elsewhere`: a voxel of the component maps to it, across the
  /// unknown voxels of a region; `own`: it lies in the component; `kept`: that, and its cell is
  /// large enough.
  enum Kind : int32_t { none, elsewhere, own, kept };
  Kind kind = none;
  int32_t squaredRadius = 0;
  Coord center;

  /// The better one of two stays: by kind, then the larger, then that of the smaller center.
  void offer(const ComponentBall& other) {
    if (std::tie(kind, squaredRadius, other.center) <
        std::tie(other.kind, other.squaredRadius, center))
      *this = other;
  }
  /// Is it kept for its component's sake alone?
  bool isRescued() const { return kind == own || kind == elsewhere; }
};

}  // namespace vdb_madf::detail
