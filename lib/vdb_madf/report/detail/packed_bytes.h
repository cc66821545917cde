// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace vdb_madf::detail {

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

/// Bytes for a web page: put one after the other, compressed on the way, given as text.
class PackedBytes {
 public:
  PackedBytes();
  ~PackedBytes();
  PackedBytes(const PackedBytes&) = delete;
  PackedBytes& operator=(const PackedBytes&) = delete;

  void bytes(const void* data, size_t count);
  /// Little-endian base 128: seven bits a byte, the last without the eighth.
  void variable(uint64_t value);
  /// Bytes 0 of all values, then bytes 1 ...: alike bytes stand together, and compress better.
  template <typename T>
  void planes(const std::vector<T>& values) {
    std::vector<uint8_t> plane(values.size());
    for (size_t shift = 0; shift < 8 * sizeof(T); shift += 8) {
      for (size_t i = 0; i < values.size(); ++i) plane[i] = uint8_t(uint64_t(values[i]) >> shift);
      bytes(plane.data(), plane.size());
    }
  }
  /// All of them as a zlib stream (RFC 1950) in base64. To be called once.
  std::string text();

 private:
  void compress(int flush);

  struct Stream;
  std::unique_ptr<Stream> stream_;
  std::vector<uint8_t> pending_;
  std::string packed_;
};

}  // namespace vdb_madf::detail
