// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/measure/bootstrap.h"

namespace vdb_madf {

/// What was varied, from `low` to `high`.
struct VariedRange {
  double low = 0, high = 0;
};

/// How much the numbers of a sample hang on the choices that its labels were made by.
struct Sensitivity {
  int runs = 0;
  VariedRange threshold;   ///< gray values
  VariedRange smooth;      ///< standard deviation, voxels
  VariedRange strictness;  ///< of the merging by score
  VariedRange gamma;       ///< voxels
  /// Mean and percentiles 2.5 and 97.5 over the runs, of numbers in voxels: `grains`,
  /// `grain_diameter_d50_by_number`, `grain_diameter_d50_by_volume`, `solid_fraction`,
  /// `specific_surface`, `mean_coordination`, `bond_area_mean`.
  std::vector<MeanInterval> intervals;
};

}  // namespace vdb_madf
