// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/detail/plot_axis.h"
#include "vdb_madf/base/detail/text.h"

#include <algorithm>
#include <cmath>

namespace vdb_madf::detail {

std::string plotNumber(double value) {
  return generalDecimal(value, 6);
}

PlotAxis::PlotAxis(std::vector<double> values, bool logarithmic, double begin, double end,
                   bool tight)
    : logarithmic_(logarithmic), begin_(begin), end_(end) {
  values.erase(std::remove_if(values.begin(), values.end(), [&](double v) { return !shows(v); }),
               values.end());
  if (values.empty()) values = {1};
  low_ = scaled(*std::min_element(values.begin(), values.end()));
  high_ = scaled(*std::max_element(values.begin(), values.end()));
  if (logarithmic_) {
    placeDecades();
  } else {
    const double low = low_, high = high_;
    placeEvenly();
    if (tight && low < high) tighten(low, high);
  }
}

void PlotAxis::tighten(double low, double high) {
  low_ = low;
  high_ = high;
  ticks_.erase(std::remove_if(ticks_.begin(), ticks_.end(),
                              [&](double tick) { return tick < low || tick > high; }),
               ticks_.end());
}

double PlotAxis::scaled(double value) const {
  return logarithmic_ ? std::log10(value) : value;
}

/// 1, 2 and 5 times powers of ten (1 alone if these are many); the axis ends at ticks.
void PlotAxis::placeDecades() {
  const bool few = high_ - low_ < 3;
  std::vector<double> all;
  for (int decade = int(std::floor(low_)); decade <= int(std::ceil(high_)) + 1; ++decade)
    for (const int digit : {1, 2, 5})
      if (few || digit == 1) all.push_back(digit * std::pow(10.0, decade));
  size_t first = 0, last = 1;
  while (first + 1 < all.size() && std::log10(all[first + 1]) <= low_ + 1e-9) ++first;
  while (last + 1 < all.size() && (std::log10(all[last]) < high_ - 1e-9 || last <= first)) ++last;
  ticks_.assign(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(last) + 1);
  low_ = std::log10(ticks_.front());
  high_ = std::log10(ticks_.back());
}

/// Multiples of 1, 2 or 5 times a power of ten; the axis ends at ticks.
void PlotAxis::placeEvenly() {
  const double least = 1e-9 * std::max(std::abs(low_), std::abs(high_));  // ticks have to differ
  if (!(high_ - low_ > least)) high_ = low_ + (low_ == 0 ? 1 : std::abs(low_) * 0.1);
  double step = std::pow(10.0, std::floor(std::log10((high_ - low_) / 5)));
  for (const double factor : {2.0, 2.5, 2.0})
    if ((high_ - low_) / step > 6) step *= factor;
  const double first = std::floor(low_ / step + 1e-9), last = std::ceil(high_ / step - 1e-9);
  for (double k = first; k <= last; ++k) ticks_.push_back(k * step);
  low_ = ticks_.front();
  high_ = ticks_.back();
}

}  // namespace vdb_madf::detail
