// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// A value that is marked in a histogram.
struct PlotMark {
  double value = 0;
  std::string name;  ///< plain letters
};

/// An SVG of a histogram: `counts` of voxels in equal bins from `low` to `high`, on a linear scale.
/// low < high, at least one bin.
std::string histogramPlot(const std::vector<double>& counts, double low, double high,
                          const std::vector<PlotMark>& marks);

}  // namespace vdb_madf
