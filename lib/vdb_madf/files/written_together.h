// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// For a file that was asked for, and others that are written with it without having been named.
/// Where one of these is there and the file is not, it comes from elsewhere.
/// @throw IoError, before anything is written, rather than that it is replaced.
void checkWrittenTogether(const std::string& path, const std::vector<std::string>& others);

}  // namespace vdb_madf
