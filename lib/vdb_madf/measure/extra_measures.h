// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/measure/given_columns.h"

namespace vdb_madf {

/// Which measures are there besides those that always are.
struct ExtraMeasures {
  bool shape = false;        ///< GrainMeasures::shape
  bool gray = false;         ///< GrainMeasures::gray, BondMeasures::gray
  bool edgeWeights = false;  ///< GrainMeasures::edgeWeight
  bool necks = false;        ///< BondMeasures::neck, Measurements::scan
  bool cells = false;        ///< GrainMeasures::cell
  bool sizes = false;        ///< GrainShape::projectedDiameter as a column
  bool bondRadii = false;    ///< BondMeasures::inscribedRadius
  /// GrainMeasures::recurrence, BondMeasures::recurrence, Measurements::sensitivity.
  bool recurrence = false;
  bool crossings = false;               ///< BondMeasures::crossing, Measurements::crossings
  bool stability = false;               ///< GrainMeasures::life, BondMeasures::vanishes
  std::vector<GivenColumn> given = {};  ///< columns of grains from outside
};

}  // namespace vdb_madf
