// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>
#include <vector>

namespace vdb_madf {

/// "a, b or c"; `last` is what stands before the last word.
inline std::string wordList(const std::vector<std::string>& words,
                            const std::string& last = " or ") {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : last) + words[i];
  return text;
}

}  // namespace vdb_madf
