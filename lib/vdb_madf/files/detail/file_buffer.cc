// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/file_buffer.h"

#include <algorithm>
#include <cstring>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Large enough that system calls do not count, small enough that an interrupt is seen at once.
constexpr size_t kBufferSize = size_t(1) << 18;

/// Where seekoff leads, or -1.
int64_t target(int64_t offset, std::ios_base::seekdir direction, int64_t position, int64_t end) {
  if (direction == std::ios_base::cur) return position + offset;
  if (direction == std::ios_base::end) return end + offset;
  return direction == std::ios_base::beg ? offset : -1;
}

}  // namespace

InputBuffer::InputBuffer(const std::string& path, Interrupter* interrupter)
    : file_(path), interrupter_(interrupter), buffer_(kBufferSize) {
  setg(buffer_.data(), buffer_.data(), buffer_.data());
}

void InputBuffer::require(int64_t bytes) const {
  if (bytes < 0 || bytes > left()) throw EarlyEnd();
}

void InputBuffer::moveTo(int64_t position) {
  if (position < 0 || position > size()) throw EarlyEnd();
  if (position >= start_ && position - start_ <= egptr() - eback()) {
    setg(eback(), eback() + (position - start_), egptr());
  } else {
    start_ = position;
    setg(buffer_.data(), buffer_.data(), buffer_.data());
  }
}

void InputBuffer::skip(int64_t bytes) {
  require(bytes);
  moveTo(position() + bytes);
}

void InputBuffer::read(void* to, int64_t bytes) {
  require(bytes);
  // The file may have been cut since it was opened.
  if (sgetn(static_cast<char*>(to), bytes) != bytes) throw EarlyEnd();
}

std::string InputBuffer::readString() {
  const auto length = read<uint32_t>();
  require(length);
  std::string text(length, '\0');
  read(text.data(), length);
  return text;
}

InputBuffer::int_type InputBuffer::underflow() {
  if (gptr() < egptr()) return traits_type::to_int_type(*gptr());
  if (interrupter_ &&
      interrupter_->wasInterrupted(int(position() * 100 / std::max<int64_t>(size(), 1))))
    throw Interrupted();
  start_ = position();
  const size_t count = file_.readSome(uint64_t(start_), buffer_.data(), buffer_.size());
  setg(buffer_.data(), buffer_.data(), buffer_.data() + count);
  return count == 0 ? traits_type::eof() : traits_type::to_int_type(*gptr());
}

InputBuffer::pos_type InputBuffer::seekoff(off_type offset, std::ios_base::seekdir direction,
                                           std::ios_base::openmode) {
  const int64_t to = target(offset, direction, position(), size());
  if (to < 0 || to > size()) return pos_type(off_type(-1));
  if (to != position()) moveTo(to);
  return pos_type(to);
}

InputBuffer::pos_type InputBuffer::seekpos(pos_type position, std::ios_base::openmode which) {
  return seekoff(off_type(position), std::ios_base::beg, which);
}

OutputBuffer::OutputBuffer(OutputStream& file, Interrupter* interrupter, int64_t unhashedStart,
                           int64_t unhashed)
    : file_(file),
      interrupter_(interrupter),
      unhashedStart_(unhashedStart),
      unhashedEnd_(unhashedStart + unhashed),
      buffer_(kBufferSize) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

void OutputBuffer::flush() {
  if (interrupter_ && interrupter_->wasInterrupted()) throw Interrupted();
  const size_t count = size_t(pptr() - pbase());
  addToHash(start_, pbase(), count);
  file_.writeAt(uint64_t(start_), pbase(), count);
  start_ += int64_t(count);
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

void OutputBuffer::replace(int64_t position, const std::string& bytes) {
  flush();
  file_.writeAt(uint64_t(position), bytes.data(), bytes.size());
}

void OutputBuffer::addToHash(int64_t position, const char* bytes, size_t count) {
  const auto addBytes = [&](int64_t first, int64_t last) {
    if (first >= last) return;
    hash_.add(uint64_t(first));
    hash_.add(uint64_t(last));
    for (const char* p = bytes + (first - position); first < last; first += 8, p += 8) {
      uint64_t word = 0;
      std::memcpy(&word, p, size_t(std::min<int64_t>(8, last - first)));
      hash_.add(word);
    }
  };
  const int64_t end = position + int64_t(count);
  addBytes(position, std::min(end, unhashedStart_));
  addBytes(std::max(position, unhashedEnd_), end);
}

OutputBuffer::int_type OutputBuffer::overflow(int_type character) {
  flush();
  if (traits_type::eq_int_type(character, traits_type::eof()))
    return traits_type::not_eof(character);
  return sputc(traits_type::to_char_type(character));
}

int OutputBuffer::sync() {
  flush();
  return 0;
}

OutputBuffer::pos_type OutputBuffer::seekoff(off_type offset, std::ios_base::seekdir direction,
                                             std::ios_base::openmode) {
  const int64_t position = start_ + (pptr() - pbase());
  const int64_t to = target(offset, direction, position, std::max(int64_t(file_.size()), position));
  if (to < 0) return pos_type(off_type(-1));
  if (to != position) {
    flush();
    start_ = to;
  }
  return pos_type(to);
}

OutputBuffer::pos_type OutputBuffer::seekpos(pos_type position, std::ios_base::openmode which) {
  return seekoff(off_type(position), std::ios_base::beg, which);
}

}  // namespace vdb_madf::detail
