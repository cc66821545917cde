// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/slabs/team.h"

namespace vdb_madf::tools {

/// The whole command: says on stderr, in one line, what is wrong. Returns the exit code.
/// @param members the processes that run this command together; null: this one alone
int runCommand(const char* program, int argc, char** argv, Team* team = nullptr);

}  // namespace vdb_madf::tools
