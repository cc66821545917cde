// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/detail/content_digest.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf::detail {

/// The file ends before what it announces.
class EarlyEnd : public std::runtime_error {
 public:
  EarlyEnd() : std::runtime_error("it ends early") {}
};

/// An InputFile behind one large buffer, for a std::istream. Unlike std::filebuf it keeps the
/// buffer when it moves within it, knows how much is left, says why a read failed, and asks the
/// interrupter whenever it is filled.
class InputBuffer final : public std::streambuf {
 public:
  /// @throw IoError if it cannot be opened or is not a regular file.
  explicit InputBuffer(const std::string& path, Interrupter* interrupter = nullptr);

  const std::string& path() const { return file_.path(); }
  int64_t size() const { return int64_t(file_.size()); }
  int64_t position() const { return start_ + (gptr() - eback()); }
  int64_t left() const { return size() - position(); }

  /// @throw EarlyEnd unless so many bytes are left.
  void require(int64_t bytes) const;
  void moveTo(int64_t position);
  void skip(int64_t bytes);
  void read(void* to, int64_t bytes);
  template <typename T>
  T read() {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    T value;
    read(&value, sizeof(T));
    return value;
  }
  /// Characters behind their 32-bit number, as OpenVDB writes strings.
  std::string readString();

  /// From now on the sum gets each part of the file that comes into the buffer.
  void tell(ContentSum* sum) { sum_ = sum; }
  /// Reads beside the buffer, from several threads if need be. @throw IoError
  void readAt(uint64_t position, void* to, size_t count) const { file_.read(position, to, count); }

 protected:
  int_type underflow() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  InputFile file_;
  Interrupter* interrupter_;
  ContentSum* sum_ = nullptr;
  int64_t start_ = 0;  ///< position of the buffer's first byte
  std::vector<char> buffer_;
};

/// An OutputStream behind one large buffer, for a std::ostream. A write that fails throws instead
/// of setting a flag, and the interrupter is asked whenever the buffer is written.
class OutputBuffer final : public std::streambuf {
 public:
  OutputBuffer(OutputStream& file, Interrupter* interrupter);

  /// Writes what is buffered. @throw IoError; Interrupted.
  void flush();

 protected:
  int_type overflow(int_type character) override;
  int sync() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  OutputStream& file_;
  Interrupter* interrupter_;
  int64_t start_ = 0;  ///< position of the buffer's first byte
  std::vector<char> buffer_;
};

}  // namespace vdb_madf::detail
