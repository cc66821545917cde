// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/output_stream.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/read_write.h"
#include "vdb_madf/files/detail/standard_descriptors.h"
#include "vdb_madf/files/standard_streams.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kBufferBytes = size_t(1) << 20;

}  // namespace

OutputStream::OutputStream(const std::string& path, Interrupter* interrupter)
    : path_(path), interrupter_(interrupter) {
  if (isStandardOutput(path)) {
    descriptor_ = openStandardOutput();
    return;
  }
  file_.emplace(path);
  descriptor_ = ::open(file_->temporaryPath().c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) fail(errno);
}

OutputStream::~OutputStream() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputStream::bytesBeyondBuffer(const void* data, size_t count) {
  if (used_ > 0 || count > kBufferBytes) flush();
  if (count > kBufferBytes) return writeAt(size_, data, count);
  if (!buffer_) buffer_.reset(new char[room_ = kBufferBytes]);  // not cleared: there may be many
  bytes(data, count);
}

void OutputStream::flush() {
  if (interrupter_ && interrupter_->wasInterrupted()) throw Interrupted();
  writeAt(size_, buffer_.get(), used_);
  used_ = 0;
}

void OutputStream::writeAt(uint64_t position, const void* data, size_t count) {
  if (!file_ && position != size_) fail(ESPIPE);
  const auto place = file_ ? std::optional<uint64_t>(position) : std::nullopt;
  if (const int error = writeWhole(descriptor_, data, count, place)) fail(error);
  size_ = std::max(size_, position + count);
}

size_t OutputStream::readAt(uint64_t position, void* to, size_t count) const {
  if (const int error = readWhole(descriptor_, to, count, position)) fail(error);
  return count;
}

void OutputStream::resize(uint64_t size) {
  if (::ftruncate(descriptor_, off_t(size)) != 0) fail(errno);
  size_ = size;
}

std::optional<std::string> OutputStream::share(uint64_t size) {
  if (!file_) return std::nullopt;
  flush();
  resize(size);
  return file_->temporaryPath();
}

void OutputStream::close() {
  flush();
  buffer_.reset();
  room_ = 0;
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) fail(errno);
}

void OutputStream::commit(bool sync) {
  if (descriptor_ >= 0) close();
  if (file_) file_->commit(sync);
}

void OutputStream::fail(int error) const {
  throw IoError("cannot write " + path_ + ": " + std::strerror(error) +
                "; free some space, or write it elsewhere");
}

}  // namespace vdb_madf::detail
