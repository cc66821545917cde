// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/output_set.h"

namespace vdb_madf {

namespace {

using detail::failToWrite;

/// As many as the system follows.
constexpr int kMaxLinks = 40;

/// Nothing but a regular file may be replaced: a rename over /dev/null would remove the device.
void checkTarget(const std::string& path) {
  if (path.empty() || path.back() == '/')
    failToWrite(path, "it names no file", "give the path of a file");
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return;
    failToWrite(path, errno);
  }
  if (S_ISDIR(status.st_mode)) failToWrite(path, "it is a folder", "give the path of a file");
  if (!S_ISREG(status.st_mode))
    failToWrite(path, "it is not a regular file", "give the path of a file");
  if (::access(path.c_str(), W_OK) != 0)
    failToWrite(path, "the file there is write-protected", "remove it, or write it elsewhere");
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

}  // namespace

OutputFile::OutputFile(std::string path) : path_(std::move(path)) {
  checkTarget(path_);
  target_ = behindLinks(path_);
  int file = -1;
  do {
    temporaryPath_ = detail::nextTemporary(detail::outputPlaceOf(target_));
    file = ::open(temporaryPath_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && (errno == EEXIST || errno == EINTR));
  if (file < 0) failToWrite(path_, errno);
  ::close(file);
}

OutputFile::~OutputFile() {
  if (!committed_) ::unlink(temporaryPath_.c_str());
}

void OutputFile::commit(bool sync) {
  if (committed_) return;
  const int file = ::open(temporaryPath_.c_str(), O_WRONLY | O_CLOEXEC);
  int error = file < 0 ? errno : 0;
  if (file >= 0 && sync && ::fsync(file) != 0 && errno != EINVAL) error = errno;
  if (file >= 0 && ::close(file) != 0 && errno != EINTR && error == 0) error = errno;
  OutputSet* const set = sync ? OutputSet::current() : nullptr;
  if (error == 0 && set) {
    set->members_.push_back({path_, target_, temporaryPath_});
    committed_ = true;
    return;
  }
  if (error == 0 && std::rename(temporaryPath_.c_str(), target_.c_str()) != 0) error = errno;
  if (error != 0) failToWrite(path_, error);
  committed_ = true;
  if (sync) detail::syncFolderOf(target_);
}

void removeLeftovers(const std::vector<std::string>& paths) {
  std::map<std::string, std::set<std::string>> stems;  // by folder, so that each is listed once
  for (const std::string& path : paths) {
    const auto [folder, name] = detail::outputPlaceOf(behindLinks(path));
    stems[folder].insert(detail::temporaryStem(name));
  }
  for (const auto& [folder, ofFolder] : stems) {
    bool areWhole = true;  // the sets of files there
    std::vector<std::filesystem::path> left;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      const auto temporary = detail::temporaryOf(entry->path().filename().string());
      if (!temporary || !detail::isGone(temporary->process)) continue;
      if (temporary->isJournal)
        areWhole = detail::undoSet(entry->path().string()) == 0 && areWhole;
      else if (ofFolder.count(temporary->stem) > 0)
        left.push_back(entry->path());
    }
    std::error_code ignored;
    for (const auto& path : left)
      if (areWhole) std::filesystem::remove_all(path, ignored);
  }
}

}  // namespace vdb_madf
