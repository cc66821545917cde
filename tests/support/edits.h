// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

#include "vdb_madf/edits/edits.h"

namespace vdb_madf::test {

inline std::vector<Edit> editsFrom(const std::vector<std::string>& texts) {
  std::vector<Edit> list;
  for (const std::string& text : texts) list.push_back(parseEdit(text));
  return list;
}

}  // namespace vdb_madf::test
