// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <string>

namespace vdb_madf {

/// A folder of files and folders that appears whole or not at all: all is written to a temporary
/// folder beside it, which commit() syncs to disk and renames. Nothing is ever replaced: the folder
/// must not be there yet, or be empty. Destroyed without commit: the temporary is removed.
class OutputTree {
 public:
  /// @throw IoError if something is there, or no folder can be made.
  explicit OutputTree(const std::string& path);
  ~OutputTree();
  OutputTree(const OutputTree&) = delete;
  OutputTree& operator=(const OutputTree&) = delete;

  /// Writes a file of this tree, "labels/grain/.zattrs"; its folders are made. Files of different
  /// names may be written at the same time. @throw IoError
  void write(const std::string& name, const void* bytes, size_t count) const;
  void write(const std::string& name, const std::string& bytes) const {
    write(name, bytes.data(), bytes.size());
  }
  /// @throw IoError if syncing or renaming fails.
  void commit();

 private:
  std::string path_, temporary_;
  bool committed_ = false;
};

/// Finds out before the work, without making it; clears away what killed runs left there.
/// @throw IoError if there can be no such folder, or something is there already.
void checkOutputTree(const std::string& path);

}  // namespace vdb_madf
