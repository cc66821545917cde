// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <limits>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The leaves of a slab along z, by their origins: begin <= z < end. By default all.
struct LeafLayers {
  int begin = std::numeric_limits<int>::min(), end = std::numeric_limits<int>::max();
  bool hold(const Coord& origin) const { return origin.z() >= begin && origin.z() < end; }
};

}  // namespace vdb_madf::detail
