// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "json_file.h"

namespace vdb_madf::tools {

Json inMillimeters(const VoxelSize& size) {
  const auto& [x, y, z] = size.edges();
  if (size.isCube()) return x * 1e3;
  return {x * 1e3, y * 1e3, z * 1e3};
}

Json coordJson(const Coord& c) {
  return {c.x(), c.y(), c.z()};
}

void addNotes(Json& json, const Progress& progress) {
  if (!progress.notes().empty()) json["notes"] = progress.notes();
}

void JsonFile::write(const Json& json) {
  // A file name need not be UTF-8: replace what is not.
  file_.write(json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace vdb_madf::tools
