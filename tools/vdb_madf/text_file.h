// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <string>

#include "vdb_madf/files/output_file.h"

namespace vdb_madf::tools {

/// Where text goes: a file, a pipe or device, standard output ("-"), or nowhere (""). Made before
/// the work, so that a path that cannot be written is told at once. @throw IoError
class TextFile {
 public:
  explicit TextFile(const std::string& path);
  /// A file appears whole or not at all. @throw IoError
  void write(const std::string& text);
  bool isStandardOutput() const { return path_ == "-"; }
  bool isNowhere() const { return path_.empty(); }

 private:
  std::string path_;
  std::unique_ptr<OutputFile> file_;
};

}  // namespace vdb_madf::tools
