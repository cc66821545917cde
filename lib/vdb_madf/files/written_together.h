// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// Protects side files that are not ours. `others` are written along with `path` (the .raw of an
/// .mhd) without having been named: if one exists and `path` does not, something else made it.
/// @throw IoError then, before anything is written
void checkWrittenTogether(const std::string& path, const std::vector<std::string>& others);

}  // namespace vdb_madf
