// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf::detail {

/// Six digits, as they stand in an SVG.
std::string plotNumber(double value);

/// From values to pixels, and where its ticks are.
class PlotAxis {
 public:
  /// Holds the values; from pixel `begin` to pixel `end`. It ends at ticks or, if it is tight and
  /// not logarithmic, at the least and largest value.
  PlotAxis(std::vector<double> values, bool logarithmic, double begin, double end,
           bool tight = false);
  bool shows(double value) const { return !logarithmic_ || value > 0; }
  double operator()(double value) const {
    return begin_ + (scaled(value) - low_) / (high_ - low_) * (end_ - begin_);
  }
  const std::vector<double>& ticks() const { return ticks_; }

 private:
  double scaled(double value) const;
  void placeDecades();
  void placeEvenly();
  void tighten(double low, double high);

  bool logarithmic_;
  double begin_, end_, low_ = 0, high_ = 1;
  std::vector<double> ticks_;
};

}  // namespace vdb_madf::detail
