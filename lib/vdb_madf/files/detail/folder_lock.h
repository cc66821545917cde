// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf::detail {

/// Holds a folder for one process at a time, or for several that share it, by a lock on the file
/// kName in it, which stays.
class FolderLock {
 public:
  static constexpr char kName[] = ".lock";
  enum class Kind { alone, shared };
  /// @throw IoError, one line, if another one holds it, or the folder cannot be written to
  explicit FolderLock(const std::string& folder, Kind kind = Kind::alone);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  /// Lets others share it from now on. @throw IoError if another one holds it by then
  void share();

 private:
  int descriptor_;
};

}  // namespace vdb_madf::detail
