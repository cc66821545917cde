// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Of a file some of the grids are read.

#include "vdb_madf/vdb/read_vdb.h"

#include <openvdb/io/Stream.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/same_grids.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

VdbReadOptions onlyAmong(const std::set<std::string>& names) {
  VdbReadOptions options;
  options.wanted = [names](const GridBase& grid) { return names.count(grid.getName()) > 0; };
  return options;
}

/// The same grids in files with offsets, ours and OpenVDB's, and in one without.
std::vector<std::string> filesOf(const TemporaryFolder& folder, const Grids& grids) {
  std::vector<std::string> paths;
  for (const char* name : {"ours.vdb", "theirs.vdb", "stream.vdb"})
    paths.push_back(folder.file(name));
  writeVdb(paths[0], grids);
  writeWithOpenVdb(paths[1], grids);
  std::ostringstream out;
  openvdb::io::Stream(out).write(grids);
  writeBytes(paths[2], out.str());
  return paths;
}

}  // namespace

TEST_CASE("vdb_file: of the grids those that are wanted are read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  const auto flags = ballWithTiles<BoolGrid>(Coord(4000, 0, -4), 5, "object");
  const auto surface = levelSet();
  for (const std::string& path : filesOf(folder, {labels, flags, surface})) {
    INFO(path);
    CHECK(readVdb(path, onlyAmong({})).empty());
    CHECK(readVdb(path, onlyAmong({"nothing"})).empty());
    for (const auto& grid : Grids{labels, flags, surface}) {
      const auto read = readVdb(path, onlyAmong({grid->getName()}));
      REQUIRE(read.size() == 1);
      CHECK(same(*grid, *read[0]));
    }
    const auto two = readVdb(path, onlyAmong({"surface", "grain"}));
    REQUIRE(two.size() == 2);
    CHECK(same(*labels, *two[0]));
    CHECK(same(*surface, *two[1]));
    VdbReadOptions numbers;
    numbers.wanted = [](const GridBase& grid) { return grid.isType<Int32Grid>(); };
    CHECK(readVdb(path, numbers).size() == 1);
  }
}

TEST_CASE("vdb_file: what is asked for a grid sees all but its tree", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  setVoxelSize(*labels, VoxelSize{8.5e-6});
  const auto surface = levelSet();
  const auto check = [&](const GridBase& grid) {
    const GridBase::ConstPtr stored =
        grid.getName() == "grain" ? GridBase::ConstPtr(labels) : surface;
    const GridBase& whole = *stored;
    CHECK(grid.getName() == whole.getName());
    CHECK(grid.type() == whole.type());
    CHECK(grid.transform() == whole.transform());
    CHECK(hasMetadataOf(whole, grid));
    CHECK(grid.empty());
  };
  for (const std::string& path : filesOf(folder, {labels, surface})) {
    INFO(path);
    std::vector<std::string> asked;
    VdbReadOptions options;
    options.wanted = [&](const GridBase& grid) {
      asked.push_back(grid.getName());
      check(grid);
      return true;
    };
    CHECK(readVdb(path, options).size() == 2);
    CHECK(asked == std::vector<std::string>{"grain", "surface"});
    const auto headers = readVdbHeaders(path);
    REQUIRE(headers.size() == 2);
    for (const auto& grid : headers) check(*grid);
  }
}

TEST_CASE("vdb_file: a tree that a wanted grid shares is read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto first = ballWithTiles<Int32Grid>(Coord(0), 9, "first");
  const auto other = ballWithTiles<BoolGrid>(Coord(0), 4, "other");
  const auto second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  const auto third = second->deepCopyGrid();
  third->setTree(first->treePtr());
  third->setName("third");
  for (const std::string& path : filesOf(folder, {first, other, second, third})) {
    INFO(path);
    for (const auto& grid : Grids{first, second, third}) {
      const auto grids = readVdb(path, onlyAmong({grid->getName()}));
      REQUIRE(grids.size() == 1);
      CHECK(same(*grid, *grids[0]));
    }
    const auto grids = readVdb(path, onlyAmong({"second", "third"}));
    REQUIRE(grids.size() == 2);
    CHECK(grids[0]->constBaseTreePtr() == grids[1]->constBaseTreePtr());
    CHECK(same(*third, *grids[1]));
    for (const auto& grid : readVdbHeaders(path)) CHECK(grid->empty());
  }
}

TEST_CASE("vdb_file: the tree of a grid that is not wanted is not read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const Unverified unverified;
  const auto labels = ballWithTiles<Int32Grid>(Coord(0), 5, "grain");
  const std::string path = folder.file("a.vdb");
  writeVdb(path, {labels, noise(300)});
  std::string bytes = bytesOf(path);
  bytes.replace(bytes.size() / 2, 8000, 8000, '\xff');  // amid the noise
  writeBytes(path, bytes);
  CHECK_FALSE(errorOf(path).empty());
  CHECK_FALSE(errorOf(path, onlyAmong({"noise"})).empty());
  CHECK(errorOf(path, onlyAmong({"grain"})).empty());
  CHECK(same(*labels, *readVdb(path, onlyAmong({"grain"})).at(0)));
  CHECK(readVdbHeaders(path).size() == 2);
  // But a file that is cut is.
  writeBytes(path, bytes.substr(0, bytes.size() - 1));
  requireOneLineNaming(errorOf(path, onlyAmong({"grain"})), path);
  CHECK_THROWS_AS(readVdbHeaders(path), IoError);

  // Nor does its size count.
  const auto large = ballWithTiles<Int32Grid>(Coord(0), 5, "large", true);
  for (const std::string& file : filesOf(folder, {labels, large})) {
    INFO(file);
    VdbReadOptions options = onlyAmong({"grain"});
    options.maxVoxels = int64_t(1) << 30;
    const bool isStream = file.find("stream") != std::string::npos;  // which is walked through
    CHECK(errorOf(file, options).empty() != isStream);
    options.wanted = nullptr;
    CHECK_FALSE(errorOf(file, options).empty());
  }
}
