// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <limits>
#include <vector>

namespace vdb_madf {

/// Which values are object. NaN never is, whatever the selection, inverted or not.
struct Selection {
  enum class Kind { nonZero, phase, threshold, range };
  Kind kind = Kind::nonZero;
  double low = 0;   ///< phase: the value; threshold: least value; range: least value
  double high = 0;  ///< range: largest value (inclusive)
  bool invert = false;
  std::vector<double> more = {};  ///< phase: further values that are object

  static Selection phase(double value) { return {Kind::phase, value, value, false}; }
  /// Any of the values, of which there is at least one.
  static Selection phases(const std::vector<double>& values) {
    return {Kind::phase, values.at(0), values[0], false, {values.begin() + 1, values.end()}};
  }
  static Selection threshold(double value) {
    return {Kind::threshold, value, std::numeric_limits<double>::infinity(), false};
  }
  static Selection range(double low, double high) { return {Kind::range, low, high, false}; }

  /// For values that are float32: there 0.7 is the number nearest to 0.7, as in NumPy.
  Selection ofFloats() const {
    const auto nearest = [](double number) {
      return number >= std::numeric_limits<float>::lowest() &&
                     number <= std::numeric_limits<float>::max()
                 ? double(float(number))
                 : number;
    };
    Selection result{kind, nearest(low), nearest(high), invert};
    for (const double value : more) result.more.push_back(nearest(value));
    return result;
  }

  bool operator()(double value) const {
    if (value != value) return false;
    bool in = kind == Kind::nonZero ? value != 0 : value >= low && value <= high;
    for (const double other : more) in |= value == other;
    return in != invert;
  }
};

}  // namespace vdb_madf
