// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/slabs/scratch.h"

namespace vdb_madf {

/// A folder with a file for each piece, compressed, with a checksum. Each file is there whole or not at
/// all, so that what a killed program left can be taken up again.
class FolderScratch : public Scratch {
 public:
  /// Makes the folder, or takes what is there, if that was made for the same work.
  /// @param work what the pieces depend on, as text
  /// @param resume take up what is there; otherwise the folder must be new or empty
  /// @throw IoError if it cannot be made or is not empty; InvalidInput if it was made for other work
  FolderScratch(std::string path, const std::string& work, bool resume);

  const std::string& path() const { return path_; }
  /// Where a file that is no piece goes.
  std::string file(const std::string& name) const;

  /// @throw IoError, one line: disk full, a piece missing or damaged ...
  void write(const std::string& name, const std::vector<char>& bytes) override;
  std::vector<char> read(const std::string& name) const override;
  bool has(const std::string& name) const override;
  void remove(const std::string& name) override;

  /// The folder and all that is in it.
  void removeAll();

 private:
  std::string path_;
};

}  // namespace vdb_madf
