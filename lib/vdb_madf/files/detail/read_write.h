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

/// Reads bytes of an open file from a position on: all, or up to the end of the file. `count`
/// becomes how many there were. @return an errno, or 0
inline int readWhole(int descriptor, void* data, size_t& count, uint64_t position) {
  size_t done = 0;
  while (done < count) {
    const ssize_t got = ::pread(descriptor, static_cast<char*>(data) + done,
                                std::min(count - done, kMaxBytesPerCall), off_t(position + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) break;
    done += size_t(got);
  }
  count = done;
  return 0;
}

}  // namespace vdb_madf::detail
