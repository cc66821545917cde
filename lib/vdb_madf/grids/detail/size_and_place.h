// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// "20x30x40 voxels", and where a box does not begin at 0: "20x30x40 voxels from 1,2,3 on".
inline std::string sizeAndPlace(const CoordBBox& box) {
  const Coord size = box.dim(), first = box.min();
  const auto join = [](const Coord& c, const std::string& with) {
    return std::to_string(c.x()) + with + std::to_string(c.y()) + with + std::to_string(c.z());
  };
  return join(size, "x") + " voxels" +
         (first == Coord(0) ? "" : " from " + join(first, ",") + " on");
}

}  // namespace vdb_madf::detail
