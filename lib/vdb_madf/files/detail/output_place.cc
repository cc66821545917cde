// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/output_place.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

namespace {

/// File systems allow names of 255 bytes; what is added to the name takes less than 55.
constexpr size_t kMaxStem = 200;
constexpr char kTemporaryEnding[] = ".tmp", kJournalEnding[] = ".undo";

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

std::string temporaryName(const std::string& stem, int process, unsigned number,
                          const char* ending) {
  return stem + std::to_string(process) + "-" + std::to_string(number) + ending;
}

std::string nextName(const OutputPlace& place, const char* ending) {
  static std::atomic<unsigned> counter{0};
  return place.folder + (place.folder == "." ? "/" : "") +
         temporaryName(temporaryStem(place.name), ::getpid(), counter++, ending);
}

}  // namespace

void failToWrite(const std::string& path, const std::string& reason, const std::string& advice) {
  throw IoError("cannot write " + path + ": " + reason + "; " + advice);
}

void failToWrite(const std::string& path, int error) {
  failToWrite(path, std::strerror(error), adviceFor(error));
}

OutputPlace outputPlaceOf(const std::string& target) {
  const std::string folder = folderOf(target);
  return {folder, folder == "." ? target : target.substr(folder.size())};
}

std::string temporaryStem(const std::string& name) {
  return "." + name.substr(0, kMaxStem) + ".";
}

std::string nextTemporary(const OutputPlace& place) {
  return nextName(place, kTemporaryEnding);
}

std::string nextJournal(const OutputPlace& place) {
  return nextName(place, kJournalEnding);
}

std::optional<Temporary> temporaryOf(const std::string& name) {
  const size_t end = name.rfind('.');
  if (end == std::string::npos || end == 0) return std::nullopt;
  const bool isJournal = name.substr(end) == kJournalEnding;
  const size_t stemEnd = name.rfind('.', end - 1);
  if (stemEnd == std::string::npos) return std::nullopt;
  const std::string stem = name.substr(0, stemEnd + 1);
  int process = 0;
  unsigned number = 0;
  if (std::sscanf(name.c_str() + stem.size(), "%d-%u", &process, &number) != 2 || process <= 0 ||
      name != temporaryName(stem, process, number, isJournal ? kJournalEnding : kTemporaryEnding))
    return std::nullopt;
  return Temporary{stem, process, isJournal};
}

bool isGone(int process) {
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

int syncFolder(const std::string& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return 0;
  const int error = ::fsync(folder) == 0 ? 0 : errno;
  ::close(folder);
  return error == EIO ? error : 0;
}

void failToLast(const std::string& target, int error) {
  throw IoError(target + ": is written, but may be lost if the machine stops: its folder: " +
                std::strerror(error) + "; check the disk");
}

void syncFolderOf(const std::string& target) {
  if (const int error = syncFolder(folderOf(target))) failToLast(target, error);
}

}  // namespace vdb_madf::detail
