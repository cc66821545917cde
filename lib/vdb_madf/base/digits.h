// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>

namespace vdb_madf {

/// How many digits tell two values to about a hundredth of their difference, `least` or more.
inline int digitsApart(double low, double high, int least) {
  if (!(high > low)) return least;
  const double ratio = std::max(std::abs(low), std::abs(high)) / (high - low);
  return std::clamp(int(std::ceil(std::log10(ratio))) + 2, least, 17);
}

}  // namespace vdb_madf
