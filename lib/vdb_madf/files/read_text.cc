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
  // Some files, such as those of /proc, do not say how large they are.
  constexpr size_t kPart = size_t(1) << 16;
  std::string text;
  for (size_t got = kPart; got == kPart;) {
    if (text.size() > mostBytes)
      throw IoError(file.name() + ": has more than the " + std::to_string(mostBytes) +
                    " bytes of a text that is expected");
    text.resize(text.size() + kPart);
    got = file.readSome(text.size() - kPart, &text[text.size() - kPart], kPart);
    text.resize(text.size() - kPart + got);
  }
  constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";
  if (text.compare(0, 3, kByteOrderMark) == 0) text.erase(0, 3);
  return text;
}

}  // namespace vdb_madf
