// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/measure/columns.h"

namespace vdb_madf {

struct Measurements;

/// Sizes of grains, `percent_passing` 0, 1 ... 100 a row: so much of the volume of all grains have
/// those of this size or smaller. A column for each kind of size, named as in the table of grains:
/// `equivalent_diameter`, `axis2_length`, `feret_min`, `projected_diameter`. Grains count by their
/// volume, if they have edge weights times these. NaN without grains.
/// @param measured with sizes (MeasureOptions::sizes)
std::vector<MeasureColumn> sizeCurve(const Measurements& measured);

/// A curve to compare with, of a sieve for example.
struct SizeReference {
  std::string unit;                               ///< of length, or "voxel": the shortest edge
  std::vector<std::pair<double, double>> points;  ///< size, percent passing; ascending
};

/// Comma-separated values: a line `size_UNIT,percent_passing` (UNIT: mm, um ... or voxel), and a
/// size and a percentage a line. @throw InvalidInput, one line, for whatever else it is; if it has
/// no percentage from 5 to 95.
SizeReference parseSizeReference(const std::string& text);

/// The shortest edge of a voxel in the unit of the curve.
/// @throw InvalidInput if only one of the two sizes is in voxels
double edgeIn(const SizeReference& reference, const std::optional<VoxelSize>& voxelSize);

/// How far the curve of a kind of size is from another.
struct SizeDeviation {
  std::string size;  ///< name of the column
  /// Root mean square, over the points of the reference from 5 to 95 %, of the difference of the
  /// percentages at its sizes; NaN without grains.
  double percent = 0;
};
/// @throw InvalidInput as edgeIn()
std::vector<SizeDeviation> sizeDeviations(const Measurements& measured,
                                          const SizeReference& reference);

}  // namespace vdb_madf
