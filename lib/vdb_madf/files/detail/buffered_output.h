// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstring>
#include <string>
#include <type_traits>

#include "vdb_madf/base/detail/byte_order.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/files/detail/output_stream.h"

namespace vdb_madf::detail {

/// Many small pieces, text or binary (little-endian), into an OutputStream.
class BufferedOutput {
 public:
  explicit BufferedOutput(const std::string& path, Interrupter* interrupter = nullptr)
      : stream_(path), interrupter_(interrupter) {
    buffer_.reserve(kCapacity);
  }

  void bytes(const void* data, size_t count) {
    if (buffer_.size() + count > kCapacity) flush();
    if (count > kCapacity)
      stream_.write(data, count);
    else
      buffer_.append(static_cast<const char*>(data), count);
  }
  template <typename T>
  void value(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&value, sizeof value);
  }
  void text(const std::string& text) { bytes(text.data(), text.size()); }
  template <typename T>
  void number(T value) {
    text(shortestDecimal(value));
  }

  /// The last of it into the temporary file; then only commitClosed() is left.
  void close() {
    flush();
    stream_.close();
    std::string().swap(buffer_);
  }
  void commitClosed() { stream_.commit(); }
  void commit() {
    close();
    commitClosed();
  }

 private:
  static constexpr size_t kCapacity = size_t(1) << 20;

  void flush() {
    if (interrupter_ && interrupter_->wasInterrupted()) throw Interrupted();
    stream_.write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }

  OutputStream stream_;
  Interrupter* interrupter_;
  std::string buffer_;
};

}  // namespace vdb_madf::detail
