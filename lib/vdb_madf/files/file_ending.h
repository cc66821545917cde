// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cctype>
#include <filesystem>
#include <string>

#include "vdb_madf/files/standard_streams.h"

namespace vdb_madf {

/// The ending of a file name with its dot, in lower case: ".vdb"; empty if there is none. That of
/// "npy:-", standard output, is ".npy".
inline std::string fileEnding(const std::string& path) {
  std::string ending = isStandardOutput(path) ? "." + path.substr(0, path.size() - 2)
                                              : std::filesystem::path(path).extension().string();
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

}  // namespace vdb_madf
