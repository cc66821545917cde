// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <functional>
#include <optional>
#include <string>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/intensity/gray_scan.h"
#include "vdb_madf/measure/measure.h"

namespace vdb_madf {

constexpr int kMinRuns = 5, kMaxRuns = 1000;

/// How far the choices are varied up and down; absent: the default that measureSensitivity() tells.
struct SensitivityOptions {
  int runs = 20;                    ///< kMinRuns to kMaxRuns
  std::optional<double> threshold;  ///< gray values
  std::optional<double> smooth;     ///< voxels
  std::optional<double> strictness;
  std::optional<double> gamma;  ///< largest least cell of a medial ball, whole voxels
  MeasureOptions measure;       ///< what counts as a surface and as a bond

  /// Says how far one of these is varied: "threshold", "smooth", "strictness" or "gamma".
  /// @return false if there is no such choice
  /// @throw InvalidInput unless the number is 0 or more, of the strictness up to kMaxStrictness
  bool vary(const std::string& name, double number);
};

/// Segments a scan by other choices than those its labels were made by, and tells what comes again:
/// sets GrainMeasures::recurrence, BondMeasures::recurrence and Measurements::sensitivity.
///
/// The labels tell the threshold, the filters and the options of the method. In each run threshold,
/// smoothing, strictness and gamma are drawn anew, evenly and independently, within bounds: the
/// threshold by a fifth of the contrast up and down, or by the noise if that is more; the smoothing
/// by half of the blur (of 0.7 voxel and the contrast of the two sides of the threshold, where the
/// scan tells no blur); the strictness by 3; gamma from its value up to 8. (Run r, from 1, takes
/// the point r of the Halton sequence of the bases 2, 3, 5 and 7; gamma goes by its logarithm.)
///
/// A grain comes again in a run if one of its grains overlaps it by more than half of the voxels
/// of either (intersection over union, compare.h). A bond does if the partners of its grains, those
/// with most voxels in common, are two and have a bond.
///
/// That the scan is the one of the labels is known by its object: that which the choices of the
/// labels make of it must be theirs, but for a thousandth of the voxels.
///
/// The scan is read, segmented and measured in each run. Memory: that of segment() and measure(),
/// besides the labels.
/// @param open the scan, anew for each run
/// @param measured what measure() says of these labels
/// @throw InvalidInput, one line, if the labels do not tell how they were made (a threshold of a
///   scan, and merging by score), they were edited or cropped since, the scan's box does not fit,
///   it is no gray one, or its object is another; what reading, segmenting and measuring throw;
///   Interrupted.
void measureSensitivity(const Int32Grid& labels, const std::function<GrayScan()>& open,
                        const SensitivityOptions& options, Measurements& measured,
                        Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
