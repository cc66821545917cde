// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "progress.h"
#include "text_file.h"
#include "vdb_madf/base/voxel_size.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::tools {

using Json = nlohmann::ordered_json;

/// The edge of a cube, or the three of another voxel.
Json inMillimeters(const VoxelSize& size);

/// The three coordinates.
Json coordJson(const Coord& c);

/// "notes", if there are any.
void addNotes(Json& json, const Progress& progress);

/// Where a machine-readable summary goes: see TextFile.
class JsonFile {
 public:
  explicit JsonFile(const std::string& path) : file_(path) {}
  void write(const Json& json);
  bool isStandardOutput() const { return file_.isStandardOutput(); }

 private:
  TextFile file_;
};

}  // namespace vdb_madf::tools
