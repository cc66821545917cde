// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// f(origin) for the leaf nodes of 8x8x8 voxels that a box meets: along z, then y, then x.
template <typename F>
void forEachLeafOrigin(const CoordBBox& box, const F& f) {
  if (box.empty()) return;
  const Coord low = box.min() & ~7, high = box.max();
  for (int x = low.x(); x <= high.x(); x += 8)
    for (int y = low.y(); y <= high.y(); y += 8)
      for (int z = low.z(); z <= high.z(); z += 8) f(Coord(x, y, z));
}

}  // namespace vdb_madf::detail
