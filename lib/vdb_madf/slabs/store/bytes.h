// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <cstring>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/slabs/scratch.h"

// Plain data as bytes, for this machine to read again.

namespace vdb_madf::detail {

class ByteWriter {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof(T));
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(uint64_t(values.size()));
    append(values.data(), values.size() * sizeof(T));
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  /// Not inlined: there GCC 12 warns of sizes below 0, for vectors that end before they begin.
  [[gnu::noinline]] void append(const void* data, size_t size) {
    if (size == 0) return;
    bytes_.resize(bytes_.size() + size);
    std::memcpy(bytes_.data() + bytes_.size() - size, data, size);
  }

  Bytes bytes_;
};

/// Reads what a ByteWriter wrote, in the same order. @throw IoError if there is less.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(std::move(bytes)) {}
  template <typename T>
  T value() {
    T result;
    std::memcpy(&result, take(1, sizeof(T)), sizeof(T));
    return result;
  }
  template <typename T>
  std::vector<T> vector() {
    const auto count = value<uint64_t>();
    const char* data = take(count, sizeof(T));
    std::vector<T> values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), data, count * sizeof(T));
    return values;
  }
  template <typename T>
  void read(T& result) {
    result = value<T>();
  }
  template <typename T>
  void read(std::vector<T>& values) {
    values = vector<T>();
  }

 private:
  const char* take(uint64_t count, size_t size) {
    if (count > (bytes_.size() - at_) / size) throw IoError("the scratch data is damaged");
    const char* data = bytes_.data() + at_;
    at_ += count * size;
    return data;
  }

  Bytes bytes_;
  size_t at_ = 0;
};

/// How a value is stored: field by field, of which its storedFields() makes a tuple of references;
/// or as it lies in memory.
template <typename T, typename = void>
struct Stored {
  static void write(ByteWriter& bytes, const T& value) { bytes.add(value); }
  static T read(ByteReader bytes) { return bytes.value<T>(); }
};
template <typename T>
struct Stored<std::vector<T>> {
  static void write(ByteWriter& bytes, const std::vector<T>& values) { bytes.add(values); }
  static std::vector<T> read(ByteReader bytes) { return bytes.vector<T>(); }
};
template <typename T>
struct Stored<T, std::void_t<decltype(T::storedFields(std::declval<T&>()))>> {
  static void write(ByteWriter& bytes, const T& value) {
    std::apply([&](const auto&... field) { (bytes.add(field), ...); }, T::storedFields(value));
  }
  static T read(ByteReader bytes) {
    T value;
    std::apply([&](auto&... field) { (bytes.read(field), ...); }, T::storedFields(value));
    return value;
  }
};

}  // namespace vdb_madf::detail
