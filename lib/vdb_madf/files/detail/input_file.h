// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace vdb_madf::detail {

/// A regular file, or "-" for standard input (standard_streams.h), open for reading at any place;
/// every read is checked.
class InputFile {
 public:
  /// @throw IoError if it is missing, not a regular file (a pipe would block) or not readable.
  explicit InputFile(const std::string& path);
  /// The data of a detached header: messages name both, the header first.
  InputFile(const std::string& header, const std::string& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// The name for messages.
  const std::string& name() const { return name_; }
  const std::string& path() const { return path_; }
  uint64_t size() const { return size_; }
  /// Exactly `count` bytes from `offset` on. @throw IoError if there are fewer.
  void read(uint64_t offset, void* to, size_t count) const;
  /// Returns how many of the `count` bytes there are: fewer at the end of the file.
  size_t readSome(uint64_t offset, void* to, size_t count) const;
  /// Reads the first `count` bytes, or as many as there are.
  std::string head(size_t count) const;

 private:
  void open();

  std::string name_, path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace vdb_madf::detail
