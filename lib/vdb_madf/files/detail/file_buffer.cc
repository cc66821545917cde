// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/file_buffer.h"

#include <algorithm>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Large enough that system calls do not count, small enough that an interrupt is seen at once.
constexpr size_t kBufferSize = ContentSum::kPart;

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
  const int64_t at = position(), before = at % int64_t(kBufferSize);
  start_ = at - before;
  const size_t count = file_.readSome(uint64_t(start_), buffer_.data(), buffer_.size());
  if (sum_) sum_->addPart(start_, buffer_.data(), count);
  char* const end = buffer_.data() + std::max(count, size_t(before));  // the file may be cut by now
  setg(buffer_.data(), buffer_.data() + before, end);
  return gptr() == egptr() ? traits_type::eof() : traits_type::to_int_type(*gptr());
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

OutputBuffer::OutputBuffer(OutputStream& file, Interrupter* interrupter)
    : file_(file), interrupter_(interrupter), buffer_(kBufferSize) {
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

void OutputBuffer::flush() {
  if (interrupter_ && interrupter_->wasInterrupted()) throw Interrupted();
  const size_t count = size_t(pptr() - pbase());
  file_.writeAt(uint64_t(start_), pbase(), count);
  start_ += int64_t(count);
  setp(buffer_.data(), buffer_.data() + buffer_.size());
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
