// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_tree.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/detail/read_write.h"
#include "vdb_madf/files/file_name.h"
#include "vdb_madf/files/output_file.h"

namespace vdb_madf {

namespace {

namespace fs = std::filesystem;
using detail::failToWrite;

void checkNothingThere(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(path, error);
  if (path.empty()) failToWrite(path, "it names no folder", "give the path of a folder");
  if (status.type() == fs::file_type::not_found) return;
  if (fs::is_directory(status) && fs::is_empty(path, error) && !error) return;
  failToWrite(path, "something is there already", "remove it first, or choose another name");
}

/// Writes a new file. Returns an errno, or 0.
int writeNew(const std::string& path, const void* bytes, size_t count) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) return errno;
  int error = detail::writeWhole(file, bytes, count);
  if (::close(file) != 0 && errno != EINTR && error == 0) error = errno;
  return error;
}

/// Of the file system that a folder lies in: many small files go to disk at once. An errno, or 0.
int syncFileSystemOf(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int error = ::syncfs(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return error;
}

}  // namespace

OutputTree::OutputTree(const std::string& path) : path_(withoutSlash(path)) {
  checkNothingThere(path_);
  int made = -1;
  do {
    temporary_ = detail::nextTemporary(detail::outputPlaceOf(path_));
    made = ::mkdir(temporary_.c_str(), 0777);
  } while (made != 0 && errno == EEXIST);
  if (made != 0) failToWrite(path_, errno);
}

OutputTree::~OutputTree() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(temporary_, ignored);
}

void OutputTree::write(const std::string& name, const void* bytes, size_t count) const {
  const fs::path file = fs::path(temporary_) / name;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  const int number = error ? error.value() : writeNew(file.string(), bytes, count);
  if (number != 0) failToWrite((fs::path(path_) / name).string(), number);
}

void OutputTree::commit() {
  if (committed_) return;
  int error = syncFileSystemOf(temporary_);
  // (A folder may be renamed over an empty one, and over nothing else.)
  if (error == 0 && std::rename(temporary_.c_str(), path_.c_str()) != 0) error = errno;
  if (error != 0) failToWrite(path_, error);
  committed_ = true;
  detail::syncFolderOf(path_);
}

void checkOutputTree(const std::string& path) {
  removeLeftovers({withoutSlash(path)});
  const OutputTree probe(path);
}

}  // namespace vdb_madf
