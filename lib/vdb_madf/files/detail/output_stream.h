// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/output_file.h"

namespace vdb_madf::detail {

/// An OutputFile that is open for writing: pieces of any size one after the other, text or binary
/// (little-endian), behind one buffer; or bytes at any place of the file. Every write is checked,
/// so that a full disk is noticed. On standard output (standard_streams.h) one piece follows the
/// other, and what was written stays written.
/// @throw IoError; Interrupted whenever the buffer is written.
class OutputStream {
 public:
  explicit OutputStream(const std::string& path, Interrupter* interrupter = nullptr);
  ~OutputStream();
  OutputStream(const OutputStream&) = delete;
  OutputStream& operator=(const OutputStream&) = delete;

  const std::string& path() const { return path_; }

  void bytes(const void* data, size_t count) {
    if (count > room_ - used_) return bytesBeyondBuffer(data, count);
    if (count == 0) return;  // `data` may be null
    std::memcpy(buffer_.get() + used_, data, count);
    used_ += count;
  }
  template <typename T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&value, sizeof value);
  }
  void text(const std::string& text) { bytes(text.data(), text.size()); }
  template <typename T>
  void number(T value) {
    char decimal[kDecimalBytes];
    bytes(decimal, size_t(writeDecimal(value, decimal) - decimal));
  }
  /// A number after a separator.
  template <typename T>
  void number(const char* separator, T value) {
    text(separator);
    number(value);
  }

  // Bytes at any place are written without the buffer: not together with the functions above.
  void writeAt(uint64_t position, const void* data, size_t count);
  /// Reads back what was written; returns how many bytes there were.
  size_t readAt(uint64_t position, void* to, size_t count) const;
  /// Cuts the file, or adds zeros to it.
  void resize(uint64_t size);
  /// The bytes that are in the file.
  uint64_t size() const { return size_; }

  /// Lets other processes write the rest of so many bytes (SharedFile): writes what is buffered,
  /// and returns the temporary. None on standard output.
  std::optional<std::string> share(uint64_t size);

  /// Writes what is buffered and frees buffer and descriptor: only commit() is left.
  void close();
  /// Closes the file if it is open; sync: as of OutputFile.
  void commit(bool sync = true);

 private:
  void bytesBeyondBuffer(const void* data, size_t count);
  void flush();
  [[noreturn]] void fail(int error) const;

  std::string path_;
  std::optional<OutputFile> file_;  ///< none: standard output
  Interrupter* interrupter_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
  std::unique_ptr<char[]> buffer_;  ///< made by the first write
  size_t room_ = 0, used_ = 0;      ///< its bytes
};

}  // namespace vdb_madf::detail
