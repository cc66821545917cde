// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "support/dense_volume.h"

namespace vdb_madf::test {

/// The values of a grid in a box, active or not, times a factor.
inline DenseVolume<int64_t> valuesIn(const Int32Grid& grid, const CoordBBox& box,
                                     int64_t factor = 1) {
  DenseVolume<int64_t> result(box);
  const auto accessor = grid.getConstAccessor();
  for (int i = 0; i < result.size(); ++i) result[i] = factor * accessor.getValue(result.coord(i));
  return result;
}

}  // namespace vdb_madf::test
