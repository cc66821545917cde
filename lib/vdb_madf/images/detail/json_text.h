// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/detail/input_file.h"

namespace vdb_madf::detail {

using Json = nlohmann::json;

/// The object in a JSON file. @throw IoError
inline Json jsonObject(const std::string& name, const std::string& path) {
  constexpr uint64_t kMaxBytes = uint64_t(1) << 22;
  const InputFile file(name, path);
  if (file.size() > kMaxBytes) throw IoError(file.name() + ": is too long for a description");
  Json json = Json::parse(file.head(kMaxBytes), nullptr, false);
  if (!json.is_object()) throw IoError(file.name() + ": is no JSON object");
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

}  // namespace vdb_madf::detail
