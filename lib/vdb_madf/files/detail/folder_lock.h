// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf::detail {

/// Holds a folder for one process at a time, by a lock on the file kName in it, which stays.
class FolderLock {
 public:
  static constexpr char kName[] = ".lock";
  /// @throw IoError, one line, if another one holds it, or the folder cannot be written to
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace vdb_madf::detail
