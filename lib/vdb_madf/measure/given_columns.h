// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "vdb_madf/measure/measure_grains.h"

namespace vdb_madf {

/// A number of grains that was found elsewhere, such as how they moved.
struct GivenColumn {
  std::string name;                  ///< letters, digits, and underscores between them
  std::map<int32_t, double> values;  ///< by grain; of others nothing is known
};

/// What a table gives.
struct GivenTable {
  std::vector<GivenColumn> columns;
  std::vector<std::string> leftOut;  ///< names as they stand in the table
};

/// The columns of a table of comma-separated values (RFC 4180) whose first line has their names,
/// one of them `grain` or `id`: those of which all cells are numbers, empty or NA. What cannot be
/// part of a name is made an underscore: `stress (MPa)` is `stress_MPa`. All others are left out,
/// and the second of one name. Of a table of the verb track, which has a column `side`, the rows
/// of the earlier scan; if it is asked for, those of the later one, whose grains then have the
/// numbers of their tracks; what is left out of it is not told.
/// @throw InvalidInput if it is no such table, a grain comes twice, or no column is left
GivenTable givenColumns(const std::string& csv, bool ofLaterScan = false);

/// A note if grains that have a number in one of the columns are not among these, else empty.
std::string noteOnGiven(const std::vector<GivenColumn>& columns,
                        const std::vector<GrainMeasures>& grains);

}  // namespace vdb_madf
