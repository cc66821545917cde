// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "input_options.h"
#include "vdb_madf/matching/pair_checks.h"

namespace vdb_madf::tools {

// Two label volumes that belong together.

/// Parses what the command line says of both; what describes RAW files (`first` has those options)
/// is for whichever of the two is RAW. @throw WrongUsage
void parsePair(InputOptions& first, InputOptions& second, const std::vector<std::string>& outputs);

/// How messages call the two.
PairNames namesOf(const InputOptions& first, const InputOptions& second);

/// The labels of a file as one slab, or those of a folder of slabs.
LabelSlabs loadSlabs(const InputOptions& input, const std::string& gridOption, Progress* progress);

}  // namespace vdb_madf::tools
