// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

/// The least value such that those up to it have at least so many per cent of all weights; 0 if
/// there are none. \p items: value, weight.
inline double weightedPercentile(std::vector<std::pair<double, double>> items, double percent) {
  double whole = 0;
  for (const auto& item : items) whole += item.second;
  std::sort(items.begin(), items.end());
  double below = 0;
  for (const auto& [value, weight] : items) {
    below += weight;
    if (100 * below >= percent * whole) return value;
  }
  return items.empty() ? 0 : items.back().first;
}

}  // namespace vdb_madf::detail
