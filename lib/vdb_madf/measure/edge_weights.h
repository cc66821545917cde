// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// How much a grain counts among those that are whole (Miles 1974; Lantuejoul 1980): a box of
/// n voxels along an axis holds a grain of m voxels, without touching its faces, at n - m - 1
/// places of those n where its first voxel lies in it. So a large grain is rarer among the whole
/// ones than it is, and the product of n / (n - m - 1) over the axes makes up for it. In L / (L -
/// l), as it is mostly written, l is one voxel more than the grain: a grain that touches a face may
/// go on beyond.
/// @return 0 for a grain that touches a face of the box
double edgeWeight(const CoordBBox& grain, const CoordBBox& box);

/// Means over all grains alike, in voxels, as in Measurements; none without grains.
std::optional<double> meanDiameter(const std::vector<GrainMeasures>& grains);
std::optional<double> meanVolume(const std::vector<GrainMeasures>& grains);

/// Numbers of a sample in which each grain counts by its weight.
struct EdgeCorrected {
  int64_t leftOut = 0;  ///< grains that touch a face: their weight is 0
  double grains = 0;    ///< sum of the weights: the grains whose first voxel is expected in the box
  /// None if no grain is whole. Lengths in voxels, as in Measurements.
  std::optional<double> meanDiameter, meanVolume, meanCoordination;
};
EdgeCorrected edgeCorrected(const std::vector<GrainMeasures>& grains);

/// diameterPercentile() of the grains by their weights, or their weights times their volumes; NaN
/// if no grain is whole.
double correctedDiameterPercentile(const std::vector<GrainMeasures>& grains, double share,
                                   bool byVolume);

}  // namespace vdb_madf
