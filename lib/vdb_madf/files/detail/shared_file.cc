// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/shared_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "vdb_madf/files/detail/output_place.h"
#include "vdb_madf/files/detail/read_write.h"

namespace vdb_madf::detail {

SharedFile::SharedFile(std::string path, const std::string& temporary)
    : path_(std::move(path)), descriptor_(::open(temporary.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (descriptor_ < 0 && errno == ENOENT)
    failToWrite(path_, "another process has made " + temporary + ", and it is not seen here",
                "choose a folder whose file system shows all processes the same");
  if (descriptor_ < 0) failToWrite(path_, errno);
}

SharedFile::~SharedFile() {
  ::close(descriptor_);
}

void SharedFile::writeAt(uint64_t position, const void* data, size_t count) {
  if (const int error = writeWhole(descriptor_, data, count, position)) failToWrite(path_, error);
}

void SharedFile::finish() {
  if (::fsync(descriptor_) != 0 && errno != EINVAL) failToWrite(path_, errno);
}

}  // namespace vdb_madf::detail
