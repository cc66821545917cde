// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf {

/// A folder for output files. It is made unless it is there; one that was made goes again, if it is
/// empty, unless it is kept.
class OutputFolder {
 public:
  /// @throw IoError if it is no folder and none can be made.
  explicit OutputFolder(std::string path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The path of a file in it.
  std::string file(const std::string& name) const;
  void keep() { isNew_ = false; }

 private:
  std::string path_;
  bool isNew_ = false;
};

/// Finds out before the work, without making it. @throw IoError if there can be no such folder.
void checkOutputFolder(const std::string& path);

}  // namespace vdb_madf
