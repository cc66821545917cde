// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

FolderLock::FolderLock(const std::string& folder, Kind kind)
    : descriptor_(::open((folder + "/" + kName).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw IoError(folder + ": cannot be written to; choose another folder");
  if (::flock(descriptor_, (kind == Kind::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0) return;
  ::close(descriptor_);
  throw IoError(folder + ": another run works in it: wait for its end");
}

FolderLock::~FolderLock() {
  ::close(descriptor_);
}

void FolderLock::share() {
  if (::flock(descriptor_, LOCK_SH | LOCK_NB) == 0) return;
  throw IoError("another run has begun in the folder of this one: wait for its end");  // just now
}

}  // namespace vdb_madf::detail
