// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/pictures/plot_type.h"

namespace vdb_madf {

/// A value that is marked in a histogram.
struct PlotMark {
  double value = 0;
  std::string name;  ///< plain letters
};

/// The bytes of a file with a histogram: `counts` of voxels in equal bins from `low` to `high`, on
/// a linear scale. low < high, at least one bin.
std::string histogramPlot(const std::vector<double>& counts, double low, double high,
                          const std::vector<PlotMark>& marks, PlotType type = PlotType::svg);

}  // namespace vdb_madf
