// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <filesystem>
#include <string>

#include "vdb_madf/base/lower_case.h"
#include "vdb_madf/files/standard_streams.h"

namespace vdb_madf {

/// The ending of a file name with its dot, in lower case: ".vdb"; empty if there is none. That of
/// "npy:-", standard output, is ".npy".
inline std::string fileEnding(const std::string& path) {
  return lowerCase(isStandardOutput(path) ? "." + path.substr(0, path.size() - 2)
                                          : std::filesystem::path(path).extension().string());
}

/// A path without the slashes at its end, of which shells write one behind a folder; "/" stays.
inline std::string withoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

/// The last part of the path of a file or a folder, with or without a slash behind it.
inline std::string lastPart(const std::string& path) {
  return std::filesystem::path(withoutSlash(path)).filename().string();
}

}  // namespace vdb_madf
