// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_set.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/detail/read_write.h"
#include "vdb_madf/files/read_text.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;
using detail::failToWrite;

thread_local OutputSet* currentSet = nullptr;

constexpr uint64_t kMaxJournalBytes = uint64_t(1) << 30;
/// Ends a journal: without it nothing was renamed yet.
constexpr char kJournalEnd[] = "end";

/// A file of a set before it is replaced.
struct Earlier {
  std::string target, backup;  ///< where it goes meanwhile; empty: there was none
};

std::string nameOf(const std::string& path) {
  return fs::path(path).filename().string();
}

/// Names that each end with a zero: two per file, then the end. An errno, or 0.
int writeJournal(const std::string& journal, const std::vector<Earlier>& files) {
  std::string text;
  for (const Earlier& file : files)
    text += nameOf(file.target) + '\0' + (file.backup.empty() ? "" : nameOf(file.backup)) + '\0';
  text += kJournalEnd + std::string(1, '\0');
  const int descriptor = ::open(journal.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return errno;
  int error = detail::writeWhole(descriptor, text.data(), text.size());
  if (error == 0 && ::fsync(descriptor) != 0 && errno != EINVAL) error = errno;
  ::close(descriptor);
  return error;
}

std::vector<Earlier> readJournal(const std::string& journal) {
  const std::string text = readText(journal, kMaxJournalBytes);
  std::vector<std::string> words;
  for (size_t begin = 0, end; (end = text.find('\0', begin)) != text.npos; begin = end + 1)
    words.push_back(text.substr(begin, end - begin));
  std::vector<Earlier> files;
  if (words.empty() || words.back() != kJournalEnd) return files;
  const fs::path folder = fs::path(journal).parent_path();
  for (size_t i = 0; i + 2 < words.size(); i += 2)
    files.push_back({(folder / words[i]).string(),
                     words[i + 1].empty() ? "" : (folder / words[i + 1]).string()});
  return files;
}

/// Keeps an earlier file under another name. Some file systems know no links. An errno, or 0.
int keepEarlier(const Earlier& file) {
  if (file.backup.empty() || ::link(file.target.c_str(), file.backup.c_str()) == 0) return 0;
  std::error_code ignored;
  if (fs::is_directory(file.target, ignored)) return EISDIR;
  return std::rename(file.target.c_str(), file.backup.c_str()) == 0 ? 0 : errno;
}

/// An errno, or 0.
int putBack(const Earlier& file) {
  if (file.backup.empty()) return ::unlink(file.target.c_str()) == 0 || errno == ENOENT ? 0 : errno;
  if (std::rename(file.backup.c_str(), file.target.c_str()) != 0)
    return errno == ENOENT ? 0 : errno;  // it was not taken away yet
  ::unlink(file.backup.c_str());         // is left by rename() if both are still one file
  return 0;
}

/// What cannot be put back now may be by the next run. An errno, or 0.
int putBack(const std::vector<Earlier>& files, const std::string& journal) {
  int error = 0;
  for (const Earlier& file : files)
    if (const int found = putBack(file)) error = found;
  if (error == 0) ::unlink(journal.c_str());
  return error;
}

}  // namespace

OutputSet::OutputSet() : outer_(std::exchange(currentSet, this)) {}

OutputSet::~OutputSet() {
  currentSet = outer_;
  for (const Member& member : members_) ::unlink(member.temporary.c_str());
}

OutputSet* OutputSet::current() {
  return currentSet;
}

void OutputSet::commit() {
  if (outer_) {
    outer_->members_.insert(outer_->members_.end(), members_.begin(), members_.end());
    return members_.clear();
  }
  if (members_.empty()) return;
  struct Folder {
    std::string journal;
    std::vector<Earlier> files;
  };
  std::map<std::string, Folder> folders;
  for (const Member& member : members_) {
    const detail::OutputPlace place = detail::outputPlaceOf(member.target);
    const bool isThere = ::access(member.target.c_str(), F_OK) == 0;
    Folder& folder = folders[place.folder];
    if (folder.journal.empty()) folder.journal = detail::nextJournal(place);
    folder.files.push_back({member.target, isThere ? detail::nextTemporary(place) : ""});
  }
  const auto fail = [&](const std::string& path, int error) {
    for (const auto& [ignored, folder] : folders) putBack(folder.files, folder.journal);
    failToWrite(path, error);
  };
  // One file alone is replaced by one step.
  const bool isOne = members_.size() == 1;
  for (const auto& [ignored, folder] : folders) {
    if (isOne) break;
    if (const int error = writeJournal(folder.journal, folder.files))
      fail(folder.files[0].target, error);
    for (const Earlier& file : folder.files)
      if (const int error = keepEarlier(file)) fail(file.target, error);
  }
  for (const Member& member : members_)
    if (std::rename(member.temporary.c_str(), member.target.c_str()) != 0) fail(member.path, errno);
  const std::string first = members_[0].target;
  members_.clear();
  int error = 0;
  for (const auto& [path, ignored] : folders)
    if (const int found = detail::syncFolder(path)) error = found;
  for (const auto& [path, folder] : folders) {
    if (isOne) break;
    ::unlink(folder.journal.c_str());
    // The journal has to be gone for good before what it speaks of is.
    if (const int found = detail::syncFolder(path)) error = found;
    for (const Earlier& file : folder.files)
      if (!file.backup.empty()) ::unlink(file.backup.c_str());
  }
  if (error != 0) detail::failToLast(first, error);
}

int detail::undoSet(const std::string& journal) {
  try {
    return putBack(readJournal(journal), journal);
  } catch (const IoError&) {
    return EIO;
  }
}

}  // namespace vdb_madf
