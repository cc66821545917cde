// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <utility>

/// Functions with the same bits on every machine, unlike the library's.
namespace vdb_madf::detail {

/// exp(x) for -64 <= x <= 8: a Taylor series on x/256, squared eight times.
inline double exponential(double x) {
  x /= 256;
  double term = 1, sum = 1;
  for (int n = 1; n <= 12; ++n) {
    term *= x / n;
    sum += term;
  }
  for (int n = 0; n < 8; ++n) sum *= sum;
  return sum;
}

/// The cube root of 1e-3 to 1e3 by Newton's method.
inline double cubeRoot(double x) {
  double root = 1;
  for (int n = 0; n < 32; ++n) root -= (root * root * root - x) / (3 * root * root);
  return root;
}

/// The sine and the cosine of -4 <= x <= 4 by their series.
inline std::pair<double, double> sineAndCosine(double x) {
  double sine = 0, cosine = 0, term = 1;
  for (int n = 0; n < 40; n += 4) {
    cosine += term;
    sine += term *= x / (n + 1);
    cosine -= term *= x / (n + 2);
    sine -= term *= x / (n + 3);
    term *= x / (n + 4);
  }
  return {sine, cosine};
}

}  // namespace vdb_madf::detail
