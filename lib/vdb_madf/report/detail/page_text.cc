// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/report/detail/page_text.h"

namespace vdb_madf::detail {

std::string dataElement(const std::string& id, const std::string& text) {
  return "<script type=\"application/octet-stream\" id=\"" + id + "\">" + text + "</script>\n";
}

std::string jsonElement(const std::string& id, const std::string& json) {
  std::string escaped;
  for (const char c : json)
    if (c == '<')
      escaped += "\\u003c";
    else
      escaped += c;
  return "<script type=\"application/json\" id=\"" + id + "\">" + escaped + "</script>\n";
}

void fillIn(const std::string& text,
            const std::function<std::string(const std::string& name)>& replacement,
            const std::function<void(const std::string&)>& write) {
  size_t written = 0;
  for (size_t begin = text.find('@'); begin != std::string::npos; begin = text.find('@', begin)) {
    const size_t end = text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ", begin + 1);
    if (end == std::string::npos || text[end] != '@' || end == begin + 1) {
      ++begin;
      continue;
    }
    write(text.substr(written, begin - written));
    write(replacement(text.substr(begin + 1, end - begin - 1)));
    written = begin = end + 1;
  }
  write(text.substr(written));
}

}  // namespace vdb_madf::detail
