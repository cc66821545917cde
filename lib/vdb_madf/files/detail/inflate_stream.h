// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <zlib.h>

#include <vector>

#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf::detail {

/// The decompressed bytes of a zlib or gzip stream that lies in a file, in order. Several gzip
/// members in a row count as one stream. @throw IoError naming the file.
class InflateStream {
 public:
  /// No byte of deflated data stands for more bytes than this (258 bytes in two bits): the bound on
  /// what a header may claim.
  static constexpr uint64_t kMaxExpansion = 1032;

  /// \param end: of the stream in the file, at the latest
  InflateStream(const InputFile& file, uint64_t offset, uint64_t end = ~uint64_t(0));
  ~InflateStream();
  InflateStream(const InflateStream&) = delete;
  InflateStream& operator=(const InflateStream&) = delete;

  void read(void* to, size_t count);
  void skip(uint64_t count);
  /// Checks that nothing is left and that the checksum is right.
  void expectEnd();

 private:
  /// Decompresses until `count` bytes are there or the stream ends; returns how many are missing.
  size_t inflateSome(unsigned char* to, size_t count);

  const InputFile& file_;
  uint64_t next_;
  const uint64_t end_;
  std::vector<unsigned char> input_;
  z_stream stream_{};
  bool ended_ = false;
};

}  // namespace vdb_madf::detail
