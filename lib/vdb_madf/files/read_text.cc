// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/read_text.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf {

std::string readText(const std::string& path, uint64_t mostBytes) {
  const detail::InputFile file(path);
  if (file.size() > mostBytes)
    throw IoError(file.name() + ": has " + std::to_string(file.size()) +
                  " bytes, and a text of at most " + std::to_string(mostBytes) + " is expected");
  return file.head(size_t(file.size()));
}

}  // namespace vdb_madf
