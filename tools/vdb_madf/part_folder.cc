// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "part_folder.h"

#include <filesystem>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/vdb/slab_folder.h"

namespace vdb_madf::tools {

namespace fs = std::filesystem;

PartFolder::PartFolder(const std::string& out) : out_(out), path_(out + ".part") {
  checkSlabFolder(out_);
  std::error_code error;
  if (!fs::create_directory(path_, error))
    throw IoError("cannot make " + path_ + ": " +
                  (error ? error.message() + "; make its folder first"
                         : "it is there; remove it, or choose another name"));
}

PartFolder::~PartFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string PartFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

void PartFolder::commit() const {
  commitSlabFolder(path_, out_);
}

}  // namespace vdb_madf::tools
