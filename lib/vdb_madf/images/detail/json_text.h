// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"
#include "vdb_madf/files/detail/json_depth.h"

namespace vdb_madf::detail {

using Json = nlohmann::json;

/// The object in a JSON file, of at most so many bytes, and not too deep. @throw IoError
inline Json jsonObject(const std::string& name, const std::string& path,
                       const Json::parser_callback_t& keep = nullptr,
                       uint64_t mostBytes = uint64_t(1) << 22) {
  const InputFile file(name, path);
  if (file.size() > mostBytes) throw IoError(file.name() + ": is too long for a description");
  Json json = Json::parse(
      file.head(mostBytes),
      [&](int depth, Json::parse_event_t event, Json& value) {
        if (depth > kMaxJsonDepth) throw IoError(file.name() + ": has too deep a description");
        return !keep || keep(depth, event, value);
      },
      false);
  if (!json.is_object()) throw IoError(file.name() + ": is no JSON object");
  return json;
}

/// Parses as above, without the members `image-label`, which have a part for each of maybe a
/// million labels; what is left may still not be long. @throw IoError
inline Json jsonObjectWithoutLabels(const std::string& name, const std::string& path) {
  constexpr uint64_t kMaxBytes = uint64_t(1) << 31;
  constexpr size_t kMaxParts = size_t(1) << 18;
  using Event = Json::parse_event_t;
  int leftOut = -1;  // the depth of such a member's key, while within it
  size_t parts = 0;
  Json json = jsonObject(
      name, path,
      [&](int depth, Event event, Json& value) {
        const bool isKey = event == Event::key;
        if (leftOut >= 0 && (depth < leftOut || (isKey && depth == leftOut))) leftOut = -1;
        if (leftOut < 0 && isKey && value == "image-label") leftOut = depth;
        if (leftOut >= 0) return false;
        return event == Event::object_end || event == Event::array_end || ++parts <= kMaxParts;
      },
      kMaxBytes);
  if (parts > kMaxParts) throw IoError(name + ": has too long a description");
  return json;
}

/// A member of an object, or null where there is none or no object.
inline const Json& member(const Json& json, const char* key) {
  static const Json kNull;
  if (!json.is_object()) return kNull;
  const auto found = json.find(key);
  return found == json.end() ? kNull : *found;
}

inline std::string textOf(const Json& json) {
  return json.is_string() ? json.get<std::string>() : std::string();
}

/// The texts of a list, empty where a part is none; of no list none.
inline std::vector<std::string> textsOf(const Json& json) {
  std::vector<std::string> texts;
  if (json.is_array())
    for (const Json& part : json) texts.push_back(textOf(part));
  return texts;
}

}  // namespace vdb_madf::detail
