// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

namespace vdb_madf {

/// The values of a scan at a set of voxels.
struct GrayValues {
  int64_t voxels = 0;    ///< with a value: NaN and infinite ones are none
  double mean = 0;       ///< this and all below: NaN without voxels
  double deviation = 0;  ///< standard deviation, of these voxels: divided by their number
  double minimum = 0, maximum = 0;
  double median = 0;  ///< of an even number the mean of the two in the middle
};

}  // namespace vdb_madf
