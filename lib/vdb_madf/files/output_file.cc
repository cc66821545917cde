// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

/// File systems allow names of 255 bytes; what is added to the name takes less than 55.
constexpr size_t kMaxStem = 200;

[[noreturn]] void fail(const std::string& path, const std::string& reason,
                       const std::string& advice) {
  throw IoError("cannot write " + path + ": " + reason + "; " + advice);
}

std::string adviceFor(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "make its folder first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "write it to a folder where you may write";
    case ENOSPC:
    case EDQUOT:
      return "free some space, or write it elsewhere";
    default:
      return "write it elsewhere";
  }
}

std::string folderOf(const std::string& path) {
  const size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

/// Nothing but a regular file may be replaced: a rename over /dev/null would remove the device.
void checkTarget(const std::string& path) {
  if (path.empty() || path.back() == '/') fail(path, "it names no file", "give the path of a file");
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return;
    const int error = errno;
    fail(path, std::strerror(error), adviceFor(error));
  }
  if (S_ISDIR(status.st_mode)) fail(path, "it is a folder", "give the path of a file");
  if (!S_ISREG(status.st_mode)) fail(path, "it is not a regular file", "give the path of a file");
  if (::access(path.c_str(), W_OK) != 0)
    fail(path, "the file there is write-protected", "remove it, or write it elsewhere");
}

/// The file that a link leads to: renaming over the link would remove the link, be it a user's or
/// /dev/stdout. A dead link is itself replaced.
std::string behindLinks(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> found(::realpath(path.c_str(), nullptr),
                                                          &std::free);
  return found ? found.get() : path;
}

/// Makes the rename last. Some file systems cannot sync a folder: the file is in place all the
/// same.
void syncFolder(const std::string& path) {
  const int folder = ::open(folderOf(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  const int error = ::fsync(folder) == 0 ? 0 : errno;
  ::close(folder);
  if (error == EIO) fail(path, std::strerror(error), "check the disk");
}

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  checkTarget(path_);
  static std::atomic<unsigned> counter{0};
  target_ = behindLinks(path_);
  const std::string folder = folderOf(target_);
  const std::string stem =
      (folder == "." ? target_ : target_.substr(folder.size())).substr(0, kMaxStem);
  // The number of the process tells programs apart, the counter threads and what a program of the
  // same number in another container left behind.
  int file = -1;
  do {
    temporaryPath_ = folder + (folder == "." ? "/." : ".") + stem + "." +
                     std::to_string(::getpid()) + "-" + std::to_string(counter++) + ".tmp";
    file = ::open(temporaryPath_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && (errno == EEXIST || errno == EINTR));
  if (file < 0) {
    const int error = errno;
    fail(path_, std::strerror(error), adviceFor(error));
  }
  ::close(file);
}

OutputFile::~OutputFile() {
  if (!committed_) ::unlink(temporaryPath_.c_str());
}

void OutputFile::commit() {
  if (committed_) return;
  const int file = ::open(temporaryPath_.c_str(), O_WRONLY | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  if (file >= 0 && ::fsync(file) != 0 && errno != EINVAL) error = errno;
  if (file >= 0 && ::close(file) != 0 && errno != EINTR && error == 0) error = errno;
  if (error == 0 && std::rename(temporaryPath_.c_str(), target_.c_str()) != 0) error = errno;
  if (error != 0) fail(path_, std::strerror(error), adviceFor(error));
  committed_ = true;
  syncFolder(target_);
}

}  // namespace vdb_madf
