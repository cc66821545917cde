// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace vdb_madf::detail {

/// The temporary of an output that another process has made and will put in its place
/// (OutputStream::share()): several write parts of it at the same time.
class SharedFile {
 public:
  /// @param path of the output, which messages name
  /// @throw IoError if this process does not see the temporary
  SharedFile(std::string path, const std::string& temporary);
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  /// @throw IoError
  void writeAt(uint64_t position, const void* data, size_t count);
  /// Syncs what was written to disk. @throw IoError
  void finish();

 private:
  std::string path_;
  int descriptor_;
};

}  // namespace vdb_madf::detail
