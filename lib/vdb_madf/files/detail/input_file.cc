// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// Linux moves at most 2 GiB in one call.
constexpr size_t kMaxBytesPerCall = size_t(1) << 30;

}  // namespace

InputFile::InputFile(const std::string& path) : name_(path) {
  open(path);
}

InputFile::InputFile(const std::string& header, const std::string& path)
    : name_(header + ": its data file " + quoted(path)) {
  open(path);
}

void InputFile::open(const std::string& path) {
  path_ = path;
  struct stat status;
  if (stat(path.c_str(), &status) != 0)
    throw IoError(name_ + ": cannot be opened: " + std::strerror(errno));
  if (!S_ISREG(status.st_mode)) throw IoError(name_ + ": is not a regular file");
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw IoError(name_ + ": cannot be opened: " + std::strerror(errno));
  size_ = uint64_t(status.st_size);
}

InputFile::~InputFile() {
  close(descriptor_);
}

void InputFile::read(uint64_t offset, void* to, size_t count) const {
  if (offset > size_ || count > size_ - offset)
    throw IoError(name_ + ": ends early: " + std::to_string(size_) + " bytes, at least " +
                  std::to_string(offset + count) + " needed");
  char* place = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = pread(descriptor_, place, std::min(count, kMaxBytesPerCall), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw IoError(name_ + ": cannot be read: " + std::strerror(errno));
    if (got == 0) throw IoError(name_ + ": became shorter while it was read");
    place += got;
    offset += uint64_t(got);
    count -= size_t(got);
  }
}

std::string InputFile::head(size_t count) const {
  std::string text(size_t(std::min<uint64_t>(count, size_)), '\0');
  read(0, text.data(), text.size());
  return text;
}

}  // namespace vdb_madf::detail
