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
#include "vdb_madf/files/detail/read_write.h"
#include "vdb_madf/files/detail/standard_descriptors.h"
#include "vdb_madf/files/standard_streams.h"

namespace vdb_madf::detail {

InputFile::InputFile(const std::string& path) : name_(path), path_(path) {
  open();
}

InputFile::InputFile(const std::string& header, const std::string& path)
    : name_(header + ": its data file " + inQuotes(path)), path_(path) {
  open();
}

void InputFile::open() {
  // Without waiting: a pipe that nobody writes to would block here.
  descriptor_ = isStandardInput(path_) ? openStandardInput()
                                       : ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  int error = descriptor_ < 0 ? errno : 0;
  struct stat status {};
  if (error == 0 && ::fstat(descriptor_, &status) != 0) error = errno;
  if (error == 0 && S_ISREG(status.st_mode)) {
    size_ = uint64_t(status.st_size);
    return;
  }
  if (descriptor_ >= 0) ::close(descriptor_);
  // (A socket cannot even be opened.)
  if (error != 0 && error != ENXIO)
    throw IoError(name_ + ": cannot be opened: " + std::strerror(error));
  throw IoError(name_ +
                (S_ISDIR(status.st_mode)
                     ? ": is a folder"
                     : ": is not a regular file; a pipe is read from standard input, as -"));
}

InputFile::~InputFile() {
  ::close(descriptor_);
}

void InputFile::read(uint64_t offset, void* to, size_t count) const {
  if (offset > size_ || count > size_ - offset)
    throw IoError(name_ + ": ends early: " + std::to_string(size_) + " bytes, at least " +
                  std::to_string(offset + count) + " needed");
  if (readSome(offset, to, count) < count)
    throw IoError(name_ + ": became shorter while it was read");
}

size_t InputFile::readSome(uint64_t offset, void* to, size_t count) const {
  if (const int error = readWhole(descriptor_, to, count, offset))
    throw IoError(name_ + ": cannot be read: " + std::strerror(error));
  return count;
}

std::string InputFile::head(size_t count) const {
  std::string text(size_t(std::min<uint64_t>(count, size_)), '\0');
  read(0, text.data(), text.size());
  return text;
}

}  // namespace vdb_madf::detail
