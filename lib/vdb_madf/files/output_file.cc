// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "vdb_madf/base/errors.h"

namespace vdb_madf {

namespace {

/// File systems allow names of 255 bytes; what is added to the name takes less than 55.
constexpr size_t kMaxStem = 200;
/// As many as the system follows.
constexpr int kMaxLinks = 40;

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

/// The file that a link leads to, even if it is not there yet: renaming over the link would remove
/// the link, be it a user's or /dev/stdout.
std::string behindLinks(std::string path) {
  for (int links = 0; links < kMaxLinks; ++links) {
    const std::unique_ptr<char, decltype(&std::free)> found(::realpath(path.c_str(), nullptr),
                                                            &std::free);
    if (found) return found.get();
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(path, error);
    if (error) break;
    path = (std::filesystem::path(path).parent_path() / next).string();
  }
  return path;
}

/// What the temporaries of a file are called: this, the number of the process, that of the file
/// within it, and an ending: ".out.vdb.1234-0.tmp".
std::string temporaryStem(const std::string& name) {
  return "." + name.substr(0, kMaxStem) + ".";
}
constexpr char kTemporaryEnding[] = ".tmp";
std::string temporaryName(const std::string& stem, int process, unsigned number) {
  return stem + std::to_string(process) + "-" + std::to_string(number) + kTemporaryEnding;
}

/// Where a file goes, in parts.
struct Place {
  std::string folder, name;  ///< the folder with its slash; "." for that of the process
};
Place placeOf(const std::string& target) {
  const std::string folder = folderOf(target);
  return {folder, folder == "." ? target : target.substr(folder.size())};
}

/// The name of a temporary in parts; nothing if it is none.
struct Temporary {
  std::string stem;
  int process = 0;
};
std::optional<Temporary> temporaryOf(const std::string& name) {
  const size_t end = name.rfind(kTemporaryEnding);
  if (end == std::string::npos || end == 0) return std::nullopt;
  const size_t stemEnd = name.rfind('.', end - 1);
  if (stemEnd == std::string::npos) return std::nullopt;
  const std::string stem = name.substr(0, stemEnd + 1);
  int process = 0;
  unsigned number = 0;
  if (std::sscanf(name.c_str() + stem.size(), "%d-%u", &process, &number) != 2 || process <= 0 ||
      name != temporaryName(stem, process, number))
    return std::nullopt;
  return Temporary{stem, process};
}

bool isGone(int process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
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
  const auto [folder, name] = placeOf(target_);
  // The number of the process tells programs apart, the counter threads and what a program of the
  // same number in another container left behind.
  int file = -1;
  do {
    temporaryPath_ = folder + (folder == "." ? "/" : "") +
                     temporaryName(temporaryStem(name), ::getpid(), counter++);
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

void removeLeftovers(const std::vector<std::string>& paths) {
  std::map<std::string, std::set<std::string>> stems;  // by folder, so that each is listed once
  for (const std::string& path : paths) {
    const auto [folder, name] = placeOf(behindLinks(path));
    stems[folder].insert(temporaryStem(name));
  }
  for (const auto& [folder, ofFolder] : stems) {
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      const auto temporary = temporaryOf(entry->path().filename().string());
      if (temporary && ofFolder.count(temporary->stem) > 0 && isGone(temporary->process))
        ::unlink(entry->path().c_str());
    }
  }
}

}  // namespace vdb_madf
