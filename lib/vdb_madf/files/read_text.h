// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <string>

namespace vdb_madf {

/// The bytes of a file of text, or of standard input ("-"), without the byte order mark that some
/// editors put at the head of UTF-8.
/// @throw IoError, one line that names the file, if it cannot be read or is longer.
std::string readText(const std::string& path, uint64_t mostBytes);

}  // namespace vdb_madf
