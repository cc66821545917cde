// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/measure_sample.h"

#include "vdb_madf/measure/detail/weighted_percentile.h"

namespace vdb_madf {

double diameterPercentile(const std::vector<GrainMeasures>& grains, double share, bool byVolume) {
  std::vector<std::pair<double, double>> sizes;
  for (const GrainMeasures& grain : grains)
    sizes.emplace_back(grain.equivalentDiameter, byVolume ? double(grain.voxels) : 1.0);
  return detail::weightedPercentile(std::move(sizes), 100 * share);
}

}  // namespace vdb_madf
