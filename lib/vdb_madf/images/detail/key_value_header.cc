// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/images/detail/key_value_header.h"

#include <algorithm>
#include <cstring>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

KeyValueHeader::KeyValueHeader(std::string path, const std::string& text,
                               const HeaderSyntax& syntax, size_t begin)
    : path_(std::move(path)), syntax_(syntax), dataOffset_(begin) {
  while (dataOffset_ < text.size() && !ended_) {
    const size_t end = std::min(text.find('\n', dataOffset_), text.size());
    addLine(text.substr(dataOffset_, end - dataOffset_));
    dataOffset_ = std::min(end + 1, text.size());
  }
}

void KeyValueHeader::addLine(const std::string& text) {
  const std::string line = trimmed(text);
  const bool blank = line.empty() && !text.empty() && text != "\r";  // which is not an empty line
  if (syntax_.endLine && line == syntax_.endLine && !blank) {
    ended_ = true;
    return;
  }
  if (line.empty() ? syntax_.skipsBlankLines : syntax_.comment && line[0] == syntax_.comment)
    return;
  const size_t separator = line.find(syntax_.separator);
  if (separator == std::string::npos) {
    if (syntax_.skipsOtherLines) return;
    throw IoError(path_ + ": not " + syntax_.article + " " + syntax_.name + ": the line " +
                  inQuotes(line) + " is not '" + syntax_.lineForm + "'");
  }
  if (syntax_.foreignSeparator &&
      line.compare(separator, std::strlen(syntax_.foreignSeparator), syntax_.foreignSeparator) == 0)
    return;
  const std::string key = trimmed(line.substr(0, separator));
  fields_.emplace_back(syntax_.canonicalKey ? syntax_.canonicalKey(key) : key,
                       trimmed(line.substr(separator + 1)));
  ended_ = syntax_.endKey && key == syntax_.endKey;
}

std::optional<std::string> KeyValueHeader::find(const std::string& key) const {
  const auto found = std::find_if(fields_.rbegin(), fields_.rend(),
                                  [&](const auto& field) { return field.first == key; });
  if (found == fields_.rend()) return std::nullopt;
  return found->second;
}

std::string KeyValueHeader::require(const std::string& key) const {
  const auto value = find(key);
  if (!value || value->empty()) failToFind(key);
  return *value;
}

std::optional<int64_t> KeyValueHeader::findInteger(const std::string& key) const {
  const auto text = find(key);
  if (!text) return std::nullopt;
  const auto values = integers(*text);
  if (!values || values->size() != 1) fail(key);
  return values->front();
}

int64_t KeyValueHeader::requireInteger(const std::string& key) const {
  const auto value = findInteger(key);
  if (!value) failToFind(key);
  return *value;
}

void KeyValueHeader::fail(const std::string& key) const {
  throw IoError(path_ + ": " + key + (syntax_.separator == '=' ? " = " : ": ") +
                inQuotes(find(key).value_or("")) + " cannot be read in this " + syntax_.name);
}

void KeyValueHeader::failToFind(const std::string& key) const {
  throw IoError(path_ + ": " + syntax_.lacks + key);
}

}  // namespace vdb_madf::detail
