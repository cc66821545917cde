// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/output_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Linux moves at most 2 GiB in one call.
constexpr size_t kMaxBytesPerCall = size_t(1) << 30;

}  // namespace

OutputStream::OutputStream(const std::string& path) : file_(path) {
  descriptor_ = open(file_.temporaryPath().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw IoError(path + ": cannot be written: " + std::strerror(errno));
}

OutputStream::~OutputStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputStream::write(const void* bytes, size_t count) {
  const char* place = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t put = ::write(descriptor_, place, std::min(count, kMaxBytesPerCall));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) throw IoError(file_.path() + ": cannot be written: " + std::strerror(errno));
    place += put;
    count -= size_t(put);
  }
}

void OutputStream::close() {
  const int result = ::close(descriptor_);
  descriptor_ = -1;
  if (result != 0) throw IoError(file_.path() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace vdb_madf::detail
