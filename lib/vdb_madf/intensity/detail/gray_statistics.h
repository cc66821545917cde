// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "vdb_madf/measure/gray_values.h"

namespace vdb_madf::detail {

/// The median; reorders the samples, of which there is at least one.
template <typename T>
double medianOf(T* begin, T* end) {
  T* const middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end);
  if ((end - begin) % 2) return double(*middle);
  return (double(*std::max_element(begin, middle)) + double(*middle)) / 2;
}

/// Mean and deviation, where the minimum is set: of integers from exact sums, of others in two
/// passes.
template <typename T>
void setMoments(const T* begin, const T* end, GrayValues& values) {
  const auto n = double(end - begin);
  if constexpr (std::is_integral_v<T>) {
    // Less the smallest: 128 bits hold what fewer than 2^32 samples (kMaxLeaves) of 32 bits make.
    using Wide = unsigned __int128;
    const auto least = int64_t(values.minimum);
    Wide sum = 0, squares = 0;
    for (const T* sample = begin; sample != end; ++sample) {
      const auto above = uint64_t(int64_t(*sample) - least);
      sum += above;
      squares += Wide(above) * above;
    }
    values.mean = values.minimum + double(sum) / n;
    values.deviation = std::sqrt(double(Wide(end - begin) * squares - sum * sum)) / n;
  } else {
    double sum = 0, squares = 0;
    for (const T* sample = begin; sample != end; ++sample) sum += double(*sample);
    values.mean = sum / n;
    for (const T* sample = begin; sample != end; ++sample)
      squares += (double(*sample) - values.mean) * (double(*sample) - values.mean);
    values.deviation = std::sqrt(squares / n);
  }
}

/// The statistics of samples, which it reorders.
template <typename T>
GrayValues grayValues(T* begin, T* end) {
  if constexpr (std::is_floating_point_v<T>)
    end = std::remove_if(begin, end, [](T sample) { return !std::isfinite(sample); });
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  GrayValues values{end - begin, kNone, kNone, kNone, kNone, kNone};
  if (begin == end) return values;
  const auto [least, largest] = std::minmax_element(begin, end);
  values.minimum = double(*least);
  values.maximum = double(*largest);
  setMoments(begin, end, values);
  values.median = medianOf(begin, end);
  return values;
}

}  // namespace vdb_madf::detail
