// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

namespace vdb_madf::detail {

/// How the volumes of grains grow with the pressures in them, to first order: a symmetric, positive
/// semidefinite matrix with a row for each grain.
struct PressureEquations {
  std::vector<double> own;          ///< per grain: its volume by its own pressure
  std::vector<uint32_t> first;      ///< per grain, one more at the end: its neighbors
  std::vector<uint32_t> neighbors;  ///< grains, for each grain ascending
  std::vector<double> byNeighbor;   ///< its volume by the pressures in them
};

/// Pressures that make the volumes grow by \p missing, each to within \p tolerance; 0 where a grain
/// does not grow with its own. By conjugate gradients, with the same bits for any number of
/// threads.
std::vector<double> pressuresFor(const PressureEquations& equations,
                                 const std::vector<double>& missing,
                                 const std::vector<double>& tolerance);

}  // namespace vdb_madf::detail
