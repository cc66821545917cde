// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_folder.h"

#include <filesystem>
#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw IoError("cannot write " + path + ": " + reason +
                "; give the path of a folder, in one that is there");
}

}  // namespace

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {
  checkOutputFolder(path_);
  std::error_code error;
  isNew_ = fs::create_directory(path_, error);
  if (error) fail(path_, error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (isNew_) fs::remove(path_, ignored);  // only if it is empty
}

std::string OutputFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

void checkOutputFolder(const std::string& path) {
  std::error_code ignored;
  const fs::path above = fs::absolute(fs::path(path) / "..", ignored).lexically_normal();
  if (fs::exists(path, ignored) ? !fs::is_directory(path, ignored)
                                : !fs::is_directory(above, ignored))
    fail(path, "it is no folder, and none can be made there");
}

}  // namespace vdb_madf
