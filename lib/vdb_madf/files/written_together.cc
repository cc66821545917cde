// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/written_together.h"

#include <filesystem>

#include "vdb_madf/base/errors.h"

namespace vdb_madf {

void checkWrittenTogether(const std::string& path, const std::vector<std::string>& others) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return;
  for (const std::string& other : others)
    if (std::filesystem::exists(other, ignored))
      throw IoError("cannot write " + path + ": " + other +
                    " would be replaced, and is there without it, so it is no earlier output; move "
                    "it away, or choose another name");
}

}  // namespace vdb_madf
