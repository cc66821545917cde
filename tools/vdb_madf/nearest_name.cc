// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "nearest_name.h"

#include <algorithm>

namespace vdb_madf::tools {

namespace {

/// Shorter beginnings could be anything.
constexpr size_t kShortestBeginning = 3;

/// Optimal string alignment: Levenshtein's distance with exchanges of neighbors.
size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> least(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        least[i][j] = i + j;
        continue;
      }
      least[i][j] = std::min({least[i - 1][j] + 1, least[i][j - 1] + 1,
                              least[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        least[i][j] = std::min(least[i][j], least[i - 2][j - 2] + 1);
    }
  return least[a.size()][b.size()];
}

}  // namespace

std::optional<std::string> nearestName(const std::string& given,
                                       const std::vector<std::string>& names) {
  std::optional<std::string> nearest;
  size_t least = given.size() / 3 + 1;
  for (const std::string& name : names) {
    const bool begins =
        given.size() >= kShortestBeginning && name.compare(0, given.size(), given) == 0;
    const size_t steps = begins ? 0 : distance(given, name);
    if (steps >= least) continue;
    least = steps;
    nearest = name;
  }
  return nearest;
}

}  // namespace vdb_madf::tools
