// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "vdb_madf/segmentation/parameter_sweep.h"

namespace vdb_madf::detail {

/// @throw InvalidInput as parameterSweep()
void checkSweep(const SweepOptions& options);

/// The grains of one way to merge, tidied.
struct SweptGrains {
  std::vector<int64_t> voxels;  ///< of grain g at g - 1
  LabelFlaws flaws;
};

/// Adds a row for each mode, delta and theta, or strictness.
void addSweepRows(const SweepOptions& options, int64_t gamma,
                  const std::function<SweptGrains(const MergeOptions& merge)>& merged,
                  std::vector<SweepRow>& rows);

}  // namespace vdb_madf::detail
