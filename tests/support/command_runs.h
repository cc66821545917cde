// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "support/catch.h"
#include "support/program.h"

/// Samples to make with the command, and what its verb 'info' says of them.
namespace vdb_madf::test {

using Json = nlohmann::json;

inline const std::string kSpheres = "generate spheres --size 40 --count 5 --radius 6:9 ";
inline const std::string kSnow = "generate snow --size 48 --length 14 --voxel-size 10um ";

inline Json infoOf(const Bench& bench, const std::string& file) {
  return Json::parse(bench.mustRun("info " + file + " --json -"));
}

inline Json gridOf(const Json& info, const std::string& name) {
  for (const Json& grid : info.at("grids"))
    if (grid.at("name") == name) return grid;
  FAIL("no grid " << name);
  return {};
}

inline std::set<std::string> gridsOf(const Json& info) {
  std::set<std::string> names;
  for (const Json& grid : info.at("grids")) names.insert(grid.at("name").get<std::string>());
  return names;
}

}  // namespace vdb_madf::test
