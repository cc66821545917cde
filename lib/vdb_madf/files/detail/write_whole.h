// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace vdb_madf::detail {

/// Linux moves at most 2 GiB in one call.
constexpr size_t kMaxBytesPerCall = size_t(1) << 30;

/// Writes all bytes to an open file, where it stands or at a position. @return an errno, or 0
inline int writeWhole(int descriptor, const void* data, size_t count,
                      std::optional<uint64_t> position = std::nullopt) {
  const char* next = static_cast<const char*>(data);
  while (count > 0) {
    const size_t some = std::min(count, kMaxBytesPerCall);
    const ssize_t put = position ? ::pwrite(descriptor, next, some, off_t(*position))
                                 : ::write(descriptor, next, some);
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    if (put == 0) return EIO;
    next += put;
    count -= size_t(put);
    if (position) *position += uint64_t(put);
  }
  return 0;
}

}  // namespace vdb_madf::detail
