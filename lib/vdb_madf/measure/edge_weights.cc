// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/edge_weights.h"

#include <limits>

#include "vdb_madf/measure/detail/weighted_percentile.h"

namespace vdb_madf {

namespace {

std::optional<double> meanOf(const std::vector<GrainMeasures>& grains,
                             double GrainMeasures::*number) {
  double sum = 0;
  for (const GrainMeasures& grain : grains) sum += grain.*number;
  return grains.empty() ? std::nullopt : std::optional(sum / double(grains.size()));
}

}  // namespace

double edgeWeight(const CoordBBox& grain, const CoordBBox& box) {
  double weight = 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (grain.min()[axis] <= box.min()[axis] || grain.max()[axis] >= box.max()[axis]) return 0;
    const double n = box.dim()[axis], m = grain.dim()[axis];
    weight *= n / (n - m - 1);
  }
  return weight;
}

std::optional<double> meanDiameter(const std::vector<GrainMeasures>& grains) {
  return meanOf(grains, &GrainMeasures::equivalentDiameter);
}

std::optional<double> meanVolume(const std::vector<GrainMeasures>& grains) {
  return meanOf(grains, &GrainMeasures::volume);
}

EdgeCorrected edgeCorrected(const std::vector<GrainMeasures>& grains) {
  EdgeCorrected corrected;
  double diameters = 0, volumes = 0, bonds = 0;
  for (const GrainMeasures& grain : grains) {
    corrected.leftOut += grain.edgeWeight > 0 ? 0 : 1;
    corrected.grains += grain.edgeWeight;
    diameters += grain.edgeWeight * grain.equivalentDiameter;
    volumes += grain.edgeWeight * grain.volume;
    bonds += grain.edgeWeight * grain.coordination;
  }
  if (corrected.grains > 0) {
    corrected.meanDiameter = diameters / corrected.grains;
    corrected.meanVolume = volumes / corrected.grains;
    corrected.meanCoordination = bonds / corrected.grains;
  }
  return corrected;
}

double correctedDiameterPercentile(const std::vector<GrainMeasures>& grains, double share,
                                   bool byVolume) {
  std::vector<std::pair<double, double>> sizes;
  for (const GrainMeasures& grain : grains)
    if (grain.edgeWeight > 0)
      sizes.emplace_back(grain.equivalentDiameter,
                         grain.edgeWeight * (byVolume ? double(grain.voxels) : 1.0));
  if (sizes.empty()) return std::numeric_limits<double>::quiet_NaN();
  return detail::weightedPercentile(std::move(sizes), 100 * share);
}

}  // namespace vdb_madf
