// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// Numbers points that come in slabs along z in the order of x, y, z of all of them, from 1 on:
/// what is kept is how many there are in each column.
class PointNumbers {
 public:
  /// The points of a slab, ascending. Of all slabs, before the first number is asked for.
  void count(const std::vector<Coord>& points);
  void finish();
  /// The numbers of the same points, of the next slab, from the lowest on.
  std::vector<uint32_t> next(const std::vector<Coord>& points);

 private:
  struct Column {
    int32_t x, y;
    uint32_t number;  ///< how many points; when finished, the number of the next one
  };
  static bool isBefore(const Column& a, const Column& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  }

  std::vector<Column> columns_;  // ascending
};

}  // namespace vdb_madf::detail
