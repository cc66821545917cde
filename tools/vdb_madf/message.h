// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf::tools {

/// "vdb_madf: KIND: WHAT" on stderr: one line, whatever a file name or a corrupt header brought
/// into it.
void printMessage(const std::string& kind, std::string what);

}  // namespace vdb_madf::tools
