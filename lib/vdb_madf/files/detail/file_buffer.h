// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <type_traits>
#include <vector>

#include "vdb_madf/base/detail/checksum.h"
#include "vdb_madf/base/interrupter.h"
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

 protected:
  int_type underflow() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  InputFile file_;
  Interrupter* interrupter_;
  int64_t start_ = 0;  ///< position of the buffer's first byte
  std::vector<char> buffer_;
};

/// An OutputStream behind one large buffer, for a std::ostream. A write that fails throws instead
/// of setting a flag, the interrupter is asked whenever the buffer is written, and what is written
/// is hashed on its way.
class OutputBuffer final : public std::streambuf {
 public:
  /// `unhashed` bytes from `unhashedStart` on are left out of the hash.
  /// @throw IoError
  OutputBuffer(OutputStream& file, Interrupter* interrupter, int64_t unhashedStart = 0,
               int64_t unhashed = 0);

  /// Writes what is buffered. @throw IoError; Interrupted.
  void flush();
  /// The writes up to the last flush: their places and their bytes.
  std::array<uint64_t, 2> hash() const { return hash_.value(); }
  /// Flushes, then replaces bytes that were written before; they are not hashed.
  void replace(int64_t position, const std::string& bytes);

 protected:
  int_type overflow(int_type character) override;
  int sync() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction,
                   std::ios_base::openmode which) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

 private:
  void addToHash(int64_t position, const char* bytes, size_t count);

  OutputStream& file_;
  Interrupter* interrupter_;
  int64_t unhashedStart_, unhashedEnd_;
  int64_t start_ = 0;  ///< position of the buffer's first byte
  std::vector<char> buffer_;
  Checksum hash_;
};

}  // namespace vdb_madf::detail
