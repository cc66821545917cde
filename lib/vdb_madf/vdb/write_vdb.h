// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Writes the grids whole or not at all: a temporary file beside `path`, every write checked,
/// synced to disk, then renamed. The file's bytes depend on its grids alone (OpenVDB's random UUID
/// is replaced by one derived from the content). If the domain of grids is a region, the file gets
/// one more, the Bool grid "region", unless it is given.
/// @throw InvalidInput if they have different regions, or another grid has that name; IoError, one
///   line that names the file (disk full, no permission, ...); Interrupted.
void writeVdb(const std::string& path, const std::vector<openvdb::GridBase::ConstPtr>& grids,
              Interrupter* interrupter = nullptr);

/// The bytes of that file. \p name: of the file, in messages. @throw as above, but no IoError
std::string vdbBytes(const std::string& name, const std::vector<openvdb::GridBase::ConstPtr>& grids,
                     Interrupter* interrupter = nullptr);

}  // namespace vdb_madf
