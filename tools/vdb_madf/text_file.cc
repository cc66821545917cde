// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "text_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "outputs.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::tools {

TextFile::TextFile(const std::string& path) : path_(isOnStandardOutput(path) ? "-" : path) {
  if (path_.empty() || path_ == "-") return;
  // A pipe or a device can only be written in place.
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status)) return;
  removeLeftovers({path});
  file_ = std::make_unique<OutputFile>(path);
}

void TextFile::write(const std::string& text) {
  if (path_.empty()) return;
  if (path_ == "-") {
    std::cout << text << std::flush;
    return;
  }
  std::ofstream stream(file_ ? file_->temporaryPath() : path_, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw IoError("cannot write " + path_ + ": " + std::strerror(errno) + "; write it elsewhere");
  if (file_) file_->commit();
}

}  // namespace vdb_madf::tools
