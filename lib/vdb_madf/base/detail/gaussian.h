// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/base/detail/portable_math.h"

namespace vdb_madf::detail {

/// A sampled Gaussian is cut at 4 sigma, rounded.
inline int gaussianRadius(double sigma) {
  return int(4 * sigma + 0.5);
}

/// One side of the normalized, sampled Gaussian, center first: the same bits on every machine.
inline std::vector<double> gaussianWeights(double sigma) {
  std::vector<double> weights;
  double sum = 0;
  for (int k = 0; k <= gaussianRadius(sigma); ++k) {
    weights.push_back(exponential(-(k * k / (2 * sigma * sigma))));
    sum += k == 0 ? weights.back() : 2 * weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace vdb_madf::detail
