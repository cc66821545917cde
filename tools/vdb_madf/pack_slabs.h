// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

#include "command.h"
#include "vdb_madf/samples/pack.h"

namespace vdb_madf::tools {

/// Writes the slabs of a sample one by one into a folder, which appears whole or not at all.
void writePackSlabs(const std::string& out, const PackSlabs& slabs, const Common& common);

}  // namespace vdb_madf::tools
