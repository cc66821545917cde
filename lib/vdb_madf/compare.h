// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "vdb_madf/grid_types.h"

namespace vdb_madf {

/// How well the labels of a test grid agree with those of a truth grid.
struct Comparison {
  int64_t truthGrains = 0, testGrains = 0;  ///< distinct labels > 0, over all voxels of each grid
  int64_t commonVoxels = 0;                 ///< labelled in both
  int64_t truthOnlyVoxels = 0, testOnlyVoxels = 0;
  /// Percent of commonVoxels. Each truth label is associated with the test label that most of its
  /// voxels have (tie: smaller id); its other voxels are misclassified (paper, section 6.1).
  /// Several truth labels may share a test label. 0 if there are no common voxels.
  double misclassifiedPercent = 0;
  /// The same with the roles of truth and test exchanged: sees over-segmentation.
  double mirrorMisclassifiedPercent = 0;
  /// Adjusted Rand index (Hubert & Arabie 1985) over the common voxels; 1: same partition.
  double adjustedRandIndex = 1;
  /// Variation of information (Meila 2007), bits (log base 2), over the common voxels; 0: same
  /// partition. Split: H(test | truth), merge: H(truth | test); their sum is the variation.
  double variationOfInformation = 0;
  double variationSplit = 0, variationMerge = 0;
};

/// Labels are the active voxels (tiles included) of positive value. Grids may differ in topology.
/// Memory: proportional to the number of (truth, test) label pairs that meet. Deterministic.
Comparison compare(const Int32Grid& truth, const Int32Grid& test,
                   Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
