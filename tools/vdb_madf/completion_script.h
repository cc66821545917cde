// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

#include "command_words.h"

namespace vdb_madf::tools {

// Scripts that complete the words of a command line, one for each shell. They hold all words: the
// command is not run while somebody types.
std::string bashCompletion(const VerbWords& command);
std::string zshCompletion(const VerbWords& command);
std::string fishCompletion(const VerbWords& command);

}  // namespace vdb_madf::tools
