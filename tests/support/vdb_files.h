// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/io/File.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/other_grids.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/verified_files.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/vdb/read_vdb.h"

/// Grids and files for the tests of VDB files.
namespace vdb_madf::test {

using Grids = std::vector<openvdb::GridBase::ConstPtr>;

template <typename T>
T valueAt(const Coord& c) {
  return T(c.x() * 3 - c.y() * 5 + c.z());
}
template <>
inline bool valueAt(const Coord& c) {
  return (c.x() + c.y()) % 2 == 0;
}

/// A ball of values around the center, with an active tile of each level beside it and an inactive
/// value that is not the background.
template <typename GridType>
typename GridType::Ptr ballWithTiles(const Coord& center, int radius, const std::string& name,
                                     bool rootTile = false) {
  using Value = typename GridType::ValueType;
  const auto grid = GridType::create();
  auto& tree = grid->tree();
  for (int x = -radius; x <= radius; ++x)
    for (int y = -radius; y <= radius; ++y)
      for (int z = -radius; z <= radius; ++z)
        if (x * x + y * y + z * z <= radius * radius)
          tree.setValue(center + Coord(x, y, z), valueAt<Value>(Coord(x, y, z)));
  tree.setValueOff(center, valueAt<Value>(Coord(7, 1, 0)));
  tree.addTile(1, center + Coord(64, 0, 0), valueAt<Value>(Coord(1, 2, 3)), true);
  tree.addTile(2, center + Coord(0, 256, 0), valueAt<Value>(Coord(4, 5, 6)), true);
  if (rootTile) tree.addTile(3, center + Coord(0, 0, 8192), valueAt<Value>(Coord(1, 1, 1)), true);
  grid->setName(name);
  return grid;
}

inline ManifoldGraph smallGraph() {
  ManifoldGraph graph;
  for (int i = 0; i < 12; ++i) graph.nodes.push_back({Coord(i, -i, 3), i + 1, 100 + i});
  for (uint32_t i = 0; i < 11; ++i) graph.edges.push_back({i, i + 1, 5 + i, 2, i % 2 == 0});
  return graph;
}

/// Distances to a sphere, positive and negative background.
inline FloatGrid::Ptr levelSet() {
  const auto grid = FloatGrid::create(3.0f);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  for (int x = -12; x <= 12; ++x)
    for (int y = -12; y <= 12; ++y)
      for (int z = -12; z <= 12; ++z) {
        const float d = std::sqrt(float(x * x + y * y + z * z)) - 9;
        if (std::abs(d) < 3)
          grid->tree().setValue(Coord(x, y, z), d);
        else if (d < 0)
          grid->tree().setValueOff(Coord(x, y, z), -3.0f);
      }
  grid->setName("surface");
  return grid;
}

/// Writes the file as another program would.
inline void writeWithOpenVdb(
    const std::string& path, const Grids& grids,
    uint32_t compression = openvdb::io::Archive::DEFAULT_COMPRESSION_FLAGS) {
  openvdb::io::File file(path);
  file.setCompression(compression);
  file.write(grids);
  file.close();
}

/// While it lives, files are not verified.
struct Unverified {
  Unverified() { setFilesAreVerified(false); }
  ~Unverified() { setFilesAreVerified(true); }
};

/// The error of reading; empty if it can be read.
inline std::string errorOf(const std::string& path, const VdbReadOptions& options = {}) {
  try {
    readVdb(path, options);
    return {};
  } catch (const IoError& error) {
    return error.what();
  }
}

inline void requireOneLineNaming(const std::string& error, const std::string& path) {
  INFO(error);
  REQUIRE(error.find(path) != std::string::npos);
  REQUIRE(error.find('\n') == std::string::npos);
  REQUIRE(error.size() < path.size() + 400);
}

}  // namespace vdb_madf::test
