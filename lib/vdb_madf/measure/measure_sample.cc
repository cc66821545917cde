// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure_sample.h"

#include <algorithm>
#include <utility>

namespace vdb_madf {

double diameterPercentile(const std::vector<GrainMeasures>& grains, double share, bool byVolume) {
  std::vector<std::pair<double, double>> sizes;  // diameter, weight
  double whole = 0;
  for (const GrainMeasures& grain : grains) {
    sizes.emplace_back(grain.equivalentDiameter, byVolume ? double(grain.voxels) : 1.0);
    whole += sizes.back().second;
  }
  std::sort(sizes.begin(), sizes.end());
  double below = 0;
  for (const auto& [diameter, weight] : sizes) {
    below += weight;
    if (below >= share * whole) return diameter;
  }
  return sizes.empty() ? 0 : sizes.back().first;
}

}  // namespace vdb_madf
