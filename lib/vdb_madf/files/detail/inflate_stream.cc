// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/inflate_stream.h"

#include <algorithm>
#include <new>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kInputBytes = size_t(1) << 18;
/// zlib counts in 32 bits.
constexpr size_t kMaxBytesPerInflate = size_t(1) << 30;
/// Widest window, header (zlib or gzip) detected.
constexpr int kWindowBits = 15 + 32;

}  // namespace

InflateStream::InflateStream(const InputFile& file, uint64_t offset, uint64_t end)
    : file_(file), next_(offset), end_(std::min(end, file.size())), input_(kInputBytes) {
  if (inflateInit2(&stream_, kWindowBits) != Z_OK) throw std::bad_alloc();
}

InflateStream::~InflateStream() {
  inflateEnd(&stream_);
}

size_t InflateStream::inflateSome(unsigned char* to, size_t count) {
  while (count > 0) {
    if (stream_.avail_in == 0 && next_ < end_) {
      const size_t bytes = size_t(std::min<uint64_t>(kInputBytes, end_ - next_));
      file_.read(next_, input_.data(), bytes);
      next_ += bytes;
      stream_.next_in = input_.data();
      stream_.avail_in = uInt(bytes);
    }
    if (ended_) {
      if (stream_.avail_in == 0) return count;
      inflateReset(&stream_);
      ended_ = false;
    }
    const size_t chunk = std::min(count, kMaxBytesPerInflate);
    const bool starved = stream_.avail_in == 0;
    stream_.next_out = to;
    stream_.avail_out = uInt(chunk);
    const int result = inflate(&stream_, Z_NO_FLUSH);
    const size_t made = chunk - stream_.avail_out;
    to += made;
    count -= made;
    if (result == Z_STREAM_END) {
      ended_ = true;
    } else if (result == Z_BUF_ERROR || result == Z_OK) {
      if (made == 0 && starved) throw IoError(file_.name() + ": the compressed data end too early");
    } else {
      throw IoError(file_.name() + ": the compressed data are damaged" +
                    (stream_.msg ? std::string(" (") + stream_.msg + ")" : std::string()));
    }
  }
  return 0;
}

void InflateStream::read(void* to, size_t count) {
  const size_t missing = inflateSome(static_cast<unsigned char*>(to), count);
  if (missing > 0)
    throw IoError(file_.name() + ": the compressed data end too early: " + std::to_string(missing) +
                  " bytes of a slice are missing");
}

void InflateStream::skip(uint64_t count) {
  std::vector<unsigned char> discarded(size_t(std::min<uint64_t>(count, kInputBytes)));
  for (; count > 0; count -= std::min<uint64_t>(count, discarded.size()))
    read(discarded.data(), size_t(std::min<uint64_t>(count, discarded.size())));
}

void InflateStream::expectEnd() {
  if (ended_) return;  // what follows is padding or another matter
  unsigned char byte;
  if (inflateSome(&byte, 1) == 0)
    throw IoError(file_.name() + ": holds more data than its header says: check size and type");
}

}  // namespace vdb_madf::detail
