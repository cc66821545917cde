// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "json_file.h"

#include <tbb/global_control.h>

#include <filesystem>
#include <fstream>
#include <iostream>

#include "vdb_madf/errors.h"

namespace vdb_madf::tools {

JsonFile::JsonFile(const std::string& path) : path_(path == "/dev/stdout" ? "-" : path) {
  if (path_.empty() || path_ == "-") return;
  // A pipe or a device can only be written in place.
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status)) return;
  file_ = std::make_unique<OutputFile>(path);
}

void JsonFile::write(const Json& json) {
  if (path_.empty()) return;
  // A file name need not be UTF-8: replace what is not.
  const std::string text = json.dump(2, ' ', false, Json::error_handler_t::replace);
  if (path_ == "-") {
    std::cout << text << std::endl;
    return;
  }
  std::ofstream stream(file_ ? file_->temporaryPath() : path_, std::ios::binary);
  stream << text << "\n";
  stream.close();
  if (!stream) throw IoError(path_ + ": cannot be written: is the disk full?");
  if (file_) file_->commit();
}

int usedThreads(const Common& common) {
  if (common.threads > 0) return common.threads;
  return int(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace vdb_madf::tools
