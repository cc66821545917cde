// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "command.h"
#include "vdb_madf/output_file.h"

namespace vdb_madf::tools {

using Json = nlohmann::ordered_json;

/// Where a machine-readable summary goes: a file, a pipe or device, standard output ("-"), or
/// nowhere (""). Made before the work, so that a path that cannot be written is told at once.
class JsonFile {
 public:
  explicit JsonFile(const std::string& path);
  /// A file appears whole or not at all.
  void write(const Json& json);
  bool isStandardOutput() const { return path_ == "-"; }

 private:
  std::string path_;
  std::unique_ptr<OutputFile> file_;
};

int usedThreads(const Common& common);

}  // namespace vdb_madf::tools
