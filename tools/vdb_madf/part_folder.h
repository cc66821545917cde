// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace vdb_madf::tools {

/// OUT.slabs.part, in which a folder of slabs is made: it goes again unless it is put in the place of
/// OUT.slabs.
class PartFolder {
 public:
  /// @throw IoError if it cannot be made, or something else is at the path of OUT
  explicit PartFolder(const std::string& out);
  ~PartFolder();
  PartFolder(const PartFolder&) = delete;
  PartFolder& operator=(const PartFolder&) = delete;

  std::string file(const std::string& name) const;
  void commit() const;

 private:
  std::string out_, path_;
};

}  // namespace vdb_madf::tools
