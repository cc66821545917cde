// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <limits>

namespace vdb_madf {

/// Which values are object. NaN never is, whatever the selection, inverted or not.
struct Selection {
  enum class Kind { nonZero, phase, threshold, range };
  Kind kind = Kind::nonZero;
  double low = 0;   ///< phase: the value; threshold: least value; range: least value
  double high = 0;  ///< range: largest value (inclusive)
  bool invert = false;

  static Selection phase(double value) { return {Kind::phase, value, value, false}; }
  static Selection threshold(double value) {
    return {Kind::threshold, value, std::numeric_limits<double>::infinity(), false};
  }
  static Selection range(double low, double high) { return {Kind::range, low, high, false}; }

  bool operator()(double value) const {
    if (value != value) return false;
    const bool in = kind == Kind::nonZero ? value != 0 : value >= low && value <= high;
    return in != invert;
  }
};

}  // namespace vdb_madf
