// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cctype>
#include <filesystem>
#include <string>

namespace vdb_madf {

/// The ending of a file name with its dot, in lower case: ".vdb"; empty if there is none.
inline std::string fileEnding(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
  return ending;
}

}  // namespace vdb_madf
