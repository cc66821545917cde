// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "support/other_grids.h"
#include "support/temporary_folder.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

/// Grids and small files of every kind, for tests and for tests/fuzz.
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

struct NamedBytes {
  std::string name, bytes;
};

/// Small files of every kind that OpenVDB and we write.
inline std::vector<NamedBytes> smallFiles() {
  initialize();
  const TemporaryFolder folder;
  std::vector<NamedBytes> files;
  const auto add = [&](const std::string& name, auto write) {
    const std::string path = folder.file(name);
    write(path);
    files.push_back({name, bytesOf(path)});
  };
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  setGraph(*labels, smallGraph());
  setDomain(*labels, CoordBBox(Coord(-20), Coord(300)));
  labels->insertMeta("flag", openvdb::BoolMetadata(true));
  const auto flags = ballWithTiles<BoolGrid>(Coord(4000, 0, -4), 5, "object");
  const auto mask = ballWithTiles<MaskGrid>(Coord(0, -8, 0), 5, "mask");
  const auto inRegion = ballWithTiles<Int32Grid>(Coord(0), 2, "color");
  setDomain(*inRegion, Domain(mask->tree()));
  const auto colors = ballWithTiles<Vec3sGrid>(Coord(1, 2, 3), 4, "color");
  const auto half = ballWithTiles<FloatGrid>(Coord(1, 2, 3), 5, "density");
  half->setSaveFloatAsHalf(true);
  const auto sharing = labels->copyWithNewTree();
  sharing->setTree(labels->treePtr());
  sharing->setName("shared");

  add("ours", [&](auto& path) { writeVdb(path, {labels, flags}); });
  add("region", [&](auto& path) { writeVdb(path, {inRegion}); });
  add("blosc", [&](auto& path) { writeWithOpenVdb(path, {labels, mask, sharing}); });
  add("zip", [&](auto& path) {
    writeWithOpenVdb(path, {labels, colors},
                     openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  });
  add("none", [&](auto& path) {
    writeWithOpenVdb(path, {flags, labels}, openvdb::io::COMPRESS_NONE);
  });
  add("level_set", [&](auto& path) { writeWithOpenVdb(path, {levelSet()}); });
  add("half", [&](auto& path) { writeWithOpenVdb(path, {half}); });
  add("half_mask", [&](auto& path) {
    writeWithOpenVdb(path, {half, levelSet()}, openvdb::io::COMPRESS_ACTIVE_MASK);
  });
  add("stream", [&](auto& path) {
    std::ofstream out(path, std::ios::binary);
    openvdb::io::Stream(out).write(Grids{labels, colors});
  });
  return files;
}

}  // namespace vdb_madf::test
