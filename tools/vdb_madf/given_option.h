// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "progress.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/measure/given_columns.h"

namespace vdb_madf::tools {

constexpr char kWithHelp[] =
    "a table with a line per grain (a column 'grain' or 'id'), such as --grains of track: its "
    "numbers become columns";

/// The columns of --with FILE; none of no file. Of labels that track numbered those of the later
/// scan. A note tells what is left out.
std::vector<GivenColumn> readGiven(const std::string& path, const Int32Grid& labels,
                                   Progress* progress);

}  // namespace vdb_madf::tools
