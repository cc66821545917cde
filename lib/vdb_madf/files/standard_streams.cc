// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/standard_streams.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/standard_descriptors.h"

namespace vdb_madf {

namespace {

constexpr size_t kPiece = size_t(1) << 20;

[[noreturn]] void fail(const std::string& what, int error, const std::string& advice = "") {
  throw IoError(what + ": " + std::strerror(error) + advice);
}

/// Closed at the end of its scope unless it is released.
class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {}
  ~Descriptor() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return descriptor_; }
  int release() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return descriptor;
  }

 private:
  int descriptor_;
};

int copyOf(int descriptor) {
  return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
}

std::string temporaryFolder() {
  const char* named = std::getenv("TMPDIR");
  return named && *named ? named : "/tmp";
}

void writeAll(int file, const char* bytes, size_t count, const std::string& folder) {
  while (count > 0) {
    const ssize_t put = ::write(file, bytes, count);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0)
      fail("standard input cannot be kept in " + folder, errno,
           "; let TMPDIR name a folder with more space");
    bytes += put;
    count -= size_t(put);
  }
}

/// A copy of what comes, in a file that has no name any more.
int spooled() {
  const std::string folder = temporaryFolder();
  std::string name = folder + "/vdb_madf-XXXXXX";
  Descriptor file(::mkostemp(name.data(), O_CLOEXEC));
  if (file < 0)
    fail("standard input cannot be kept in " + folder, errno,
         "; let TMPDIR name a folder where you may write");
  ::unlink(name.c_str());
  std::vector<char> piece(kPiece);
  for (;;) {
    const ssize_t got = ::read(STDIN_FILENO, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("standard input cannot be read", errno);
    if (got == 0) return file.release();
    writeAll(file, piece.data(), size_t(got), folder);
  }
}

/// The descriptor of what can be read at any place.
int keep() {
  struct stat status {};
  if (::fstat(STDIN_FILENO, &status) != 0) fail("standard input cannot be read", errno);
  if (::isatty(STDIN_FILENO))
    throw IoError("standard input is a terminal: send a file to it, or give a path");
  // A file whose beginning nobody has taken yet serves as it is.
  if (S_ISREG(status.st_mode) && ::lseek(STDIN_FILENO, 0, SEEK_CUR) == 0)
    return copyOf(STDIN_FILENO);
  return spooled();
}

int kept() {
  static const Descriptor descriptor(keep());
  return descriptor;
}

}  // namespace

void keepStandardInput() {
  kept();
}

int detail::openStandardInput() {
  const int descriptor = copyOf(kept());
  if (descriptor < 0) fail("standard input cannot be read", errno);
  return descriptor;
}

int detail::openStandardOutput() {
  if (::isatty(STDOUT_FILENO))
    throw IoError("standard output is a terminal: send it to a file or to a program");
  const int descriptor = copyOf(STDOUT_FILENO);
  if (descriptor < 0) fail("standard output cannot be written", errno);
  return descriptor;
}

}  // namespace vdb_madf
