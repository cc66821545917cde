// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/ranks.h"

namespace vdb_madf::tools {

/// The whole command: says on stderr, in one line, what is wrong. Returns the exit code.
/// @param ranks the processes that run this command together; null: this one alone
int runCommand(const char* program, int argc, char** argv, Ranks* ranks = nullptr);

}  // namespace vdb_madf::tools
