// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace vdb_madf {

/// A number of grains that was found elsewhere, such as how they moved.
struct GivenColumn {
  std::string name;                  ///< letters, digits, underscores
  std::map<int32_t, double> values;  ///< by grain; of others nothing is known
};

/// The columns of a table of comma-separated values whose first line has their names, one of them
/// `grain` or `id`: those of which all cells are numbers or empty. Of a table of the verb track,
/// which has a column `side`, the rows of the earlier scan; if it is asked for, those of the later
/// one, whose grains then have the numbers of their tracks.
/// @throw InvalidInput if it is no such table, a grain comes twice, or no column is left
std::vector<GivenColumn> givenColumns(const std::string& csv, bool ofLaterScan = false);

}  // namespace vdb_madf
