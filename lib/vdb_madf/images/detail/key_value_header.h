// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace vdb_madf::detail {

/// How a text header writes its keys and values, and what messages call it.
struct HeaderSyntax {
  const char* article = "a";
  const char* name = "";      ///< "MetaImage header"
  const char* lacks = "";     ///< what precedes the missing key: "the MetaImage header lacks "
  const char* lineForm = "";  ///< of a line, for messages: "Key = Value"
  char separator = '=';
  /// Lines with this separator are ignored: a program's own keys.
  const char* foreignSeparator = nullptr;
  char comment = '\0';  ///< the first character of lines that are ignored
  /// The header ends with this line, with the line of this key, or with the text.
  const char* endLine = nullptr;
  const char* endKey = nullptr;
  bool skipsBlankLines = false;
  bool skipsOtherLines = false;  ///< a line without a separator is no error
  /// The form in which keys are kept and looked for; nullptr: without white space at both ends.
  std::string (*canonicalKey)(const std::string& key) = nullptr;
};

/// The keys and values of a text header, in the order of the file. Of a key that comes more than
/// once the last value counts.
class KeyValueHeader {
 public:
  /// @param path for messages
  /// @param begin where in the text the first line begins
  /// @throw IoError for a line that is no key and value.
  KeyValueHeader(std::string path, const std::string& text, const HeaderSyntax& syntax,
                 size_t begin = 0);

  const std::vector<std::pair<std::string, std::string>>& fields() const { return fields_; }
  /// True if the line or the key that ends the header was found.
  bool ended() const { return ended_; }
  /// The place in the text at which the line after the header begins.
  size_t dataOffset() const { return dataOffset_; }

  bool has(const std::string& key) const { return find(key).has_value(); }
  std::optional<std::string> find(const std::string& key) const;
  /// @throw IoError if there is no such key, or if its value is empty.
  std::string require(const std::string& key) const;
  /// @throw IoError if the value is not one integer.
  std::optional<int64_t> findInteger(const std::string& key) const;
  /// @throw IoError if there is no such key, or if its value is not one integer.
  int64_t requireInteger(const std::string& key) const;

  /// @throw IoError: the value of this key cannot be read.
  [[noreturn]] void fail(const std::string& key) const;

 private:
  void addLine(const std::string& line);
  [[noreturn]] void failToFind(const std::string& key) const;

  std::string path_;
  HeaderSyntax syntax_;
  std::vector<std::pair<std::string, std::string>> fields_;
  size_t dataOffset_;
  bool ended_ = false;
};

}  // namespace vdb_madf::detail
