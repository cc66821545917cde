// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

/// Voxels that have a pair of labels; 0: labelled in the other grid only.
struct Overlap {
  int32_t truth = 0, test = 0;
  int64_t voxels = 0;
};

/// A grain and the grain of the other grid that it is associated with: its partner.
struct GrainMatch {
  int32_t grain = 0;
  int64_t voxels = 0;
  int32_t partner = 0;               ///< most voxels in common (tie: smaller id); 0: none in common
  int64_t overlapVoxels = 0;         ///< in common with the partner
  double intersectionOverUnion = 0;  ///< of grain and partner, over all voxels of either
  int64_t pieces = 0;                ///< grains of the other grid whose partner this grain is
};

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
  /// Truth grains with an intersection over union above 1/2: their partner can be no other's match.
  int64_t foundGrains = 0;
  double meanIntersectionOverUnion = 0;  ///< over the truth grains; 0 without any
  int64_t splits = 0;                    ///< truth grains of two or more pieces, see splits()
  int64_t merges = 0;                    ///< test grains of two or more pieces, see merges()
  /// One per grain, ascending.
  std::vector<GrainMatch> truthMatches, testMatches;
  std::vector<Overlap> overlaps;  ///< the confusion matrix: pairs that meet; by truth, then test
};

/// A grain and the grains of the other grid that lie in it, ascending.
struct GrainGroup {
  int32_t grain = 0;
  std::vector<int32_t> parts;
};
/// Truth grains that came apart: two or more test grains have most of their voxels (of those that
/// the truth labels; tie: smaller id) in each. A border that is only misplaced splits nothing.
std::vector<GrainGroup> splits(const Comparison& comparison);
/// Test grains that two or more truth grains went into: the same with the roles exchanged.
std::vector<GrainGroup> merges(const Comparison& comparison);

/// Labels are the active voxels (tiles included) of positive value. Grids may differ in topology:
/// what one of them lacks is counted in truthOnlyVoxels and testOnlyVoxels. Memory: proportional to
/// the number of (truth, test) label pairs that meet. Deterministic.
Comparison compare(const Int32Grid& truth, const Int32Grid& test,
                   Interrupter* interrupter = nullptr);

/// The same of labels in slabs, which need not fit in memory together; they may be cut elsewhere. One
/// slab of each is held at a time, or the layers that lie in one of the other.
/// @throw as above; what reading throws.
Comparison compare(const LabelSlabs& truth, const LabelSlabs& test,
                   Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
