// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf::tools {

/// The version of the command, and in lines below it what it was built with and runs with:
/// OpenVDB's version, the instruction set, optional formats.
std::string versionText();

}  // namespace vdb_madf::tools
