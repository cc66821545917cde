// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "vdb_madf/base/interrupter.h"

namespace vdb_madf::detail {

/// A checksum of the bytes of a file, whose parts are added in any order, by any thread. It finds
/// every change within eight bytes, and others as if by chance; it is no defense against forgery.
class ContentSum {
 public:
  static constexpr size_t kPart = size_t(1) << 18;

  /// @param size bytes of the file
  /// @param left bytes from `leftStart` on that are left out
  ContentSum(int64_t size, int64_t leftStart, int64_t left);
  /// Adds a part of the file, kPart bytes or what the last one has, unless it was added before.
  void addPart(int64_t position, const char* bytes, size_t count);
  /// Adds in parallel, with a function that reads them, all parts that were not added before.
  using Read = std::function<void(uint64_t position, char* to, size_t count)>;
  void addRest(const Read& read, Interrupter* interrupter);
  std::array<uint64_t, 2> value() const { return {sums_[0], sums_[1]}; }

 private:
  void addPiece(int64_t first, int64_t last, const char* bytes);

  int64_t size_, leftStart_, leftEnd_;
  std::vector<char> added_;  ///< of each part
  std::array<std::atomic<uint64_t>, 2> sums_{};
};

/// The name of the digest among what a file says of itself.
constexpr char kDigestKey[] = "digest";

/// 32 hexadecimal digits.
std::string digestOf(const std::string& bytes);

/// Refuses a file, if files are verified, whose content has another digest than it says. Nothing
/// happens where `stored` is empty.
/// @throw IoError, one line
void requireDigest(const std::string& file, const std::string& stored, const std::string& found);

}  // namespace vdb_madf::detail
