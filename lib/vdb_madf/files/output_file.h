// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// A file that appears whole or not at all: write to temporaryPath() (same folder), then commit()
/// syncs it to disk and renames it over `path`. Through a link it goes to where the link leads, be
/// there a file or not yet, and the temporary is in that folder.
/// Destroyed without commit: the temporary is removed.
class OutputFile {
 public:
  /// @throw IoError if a file cannot be made there.
  explicit OutputFile(std::string path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& temporaryPath() const { return temporaryPath_; }
  /// Where an OutputSet lives, only that puts the file in place, if it is synced.
  /// @param sync wait until all is on the disk, so that a power failure loses nothing
  /// @throw IoError if syncing or renaming fails.
  void commit(bool sync = true);

 private:
  std::string path_, target_, temporaryPath_;
  bool committed_ = false;
};

/// Removes what is left of killed programs that were writing these files or folders: the
/// temporaries with the number of a process that does not exist (on this machine). Sets of which
/// such a program had replaced a part (OutputSet), in these folders, are put back. What cannot be
/// removed stays.
void removeLeftovers(const std::vector<std::string>& paths);

}  // namespace vdb_madf
