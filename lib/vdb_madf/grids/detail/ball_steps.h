// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The steps of at most a length with their squared lengths, the shortest first, then in the order
/// of coordinates.
inline std::vector<std::pair<int, Coord>> ballSteps(double length) {
  std::vector<std::pair<int, Coord>> steps;
  const Coord reach{int(length)};
  for (auto p = CoordBBox(-reach, reach).begin(); p; ++p) {
    const Coord& step = *p;
    const int squared = step.x() * step.x() + step.y() * step.y() + step.z() * step.z();
    if (squared <= length * length) steps.emplace_back(squared, step);
  }
  std::sort(steps.begin(), steps.end());
  return steps;
}

}  // namespace vdb_madf::detail
