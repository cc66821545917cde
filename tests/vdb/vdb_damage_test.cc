// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <set>

#include "support/catch.h"
#include "support/damage.h"
#include "support/files.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

// VDB files that cannot be read: other files, cut or damaged ones, and those beyond the limits.

using namespace vdb_madf;
using namespace vdb_madf::test;
TEST_CASE("vdb_file: what is no VDB file is refused by name", "[vdb_file]") {
  const TemporaryFolder folder;
  const auto refused = [](const std::string& path, const std::string& reason) {
    const std::string error = errorOf(path);
    requireOneLineNaming(error, path);
    CHECK_THAT(error, vdb_madf::test::Contains(reason));
  };
  refused(folder.file("missing.vdb"), "No such file");
  refused(folder.path(), "folder");
  refused("/dev/zero", "not a regular file");
  writeBytes(folder.file("file"), "");
  refused(folder.file("file"), "empty");
  refused(folder.file("file/below.vdb"), "Not a directory");
  for (const std::string& garbage :
       {std::string("x"), std::string("1234567"), std::string("a\nb\x1b[31m"),
        std::string(100000, 'V'), std::string(100, '\0')}) {
    writeBytes(folder.file("garbage.vdb"), garbage);
    refused(folder.file("garbage.vdb"), "not a VDB file");
  }
}

TEST_CASE("vdb_file: other versions of the format are refused", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const Unverified unverified;
  writeVdb(path, {ballWithTiles<Int32Grid>(Coord(0), 3, "grain")});
  std::string bytes = bytesOf(path);
  const uint32_t next = openvdb::OPENVDB_FILE_VERSION + 1;
  for (const uint32_t version : {0u, 212u, 221u, next, 0x80000000u, 0xffffffffu}) {
    std::memcpy(&bytes[8], &version, 4);
    writeBytes(path, bytes);
    const std::string error = errorOf(path);
    requireOneLineNaming(error, path);
    CHECK_THAT(error, vdb_madf::test::Contains("format " + std::to_string(version)));
  }
  for (uint32_t version = 222; version < next; ++version) {
    std::memcpy(&bytes[8], &version, 4);
    writeBytes(path, bytes);
    CHECK(errorOf(path).empty());
  }
}

TEST_CASE("vdb_file: a file that is cut anywhere is refused", "[vdb_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("cut.vdb");
  std::mt19937 random(1);
  for (const auto& [name, bytes] : smallFiles()) {
    INFO(name);
    std::set<size_t> lengths;
    for (size_t i = 0; i < 300; ++i) lengths.insert(i * 3);
    for (size_t i = 1; i < 60; ++i) lengths.insert(bytes.size() - i);
    for (size_t i = 0; i < 150; ++i) lengths.insert(random() % bytes.size());
    overwriteFile(path, bytes);
    for (auto length = lengths.rbegin(); length != lengths.rend(); ++length) {
      INFO("length " << *length << " of " << bytes.size());
      std::filesystem::resize_file(path, *length);
      requireOneLineNaming(errorOf(path), path);
    }
    overwriteFile(path, bytes);
    REQUIRE(errorOf(path).empty());
    overwriteFile(path, bytes + 'x');
    requireOneLineNaming(errorOf(path), path);
  }
}

TEST_CASE("vdb_file: damaged files are read or refused, quickly and in little memory",
          "[vdb_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("damaged.vdb");
  const Unverified unverified;
  // An allocation beyond it ends this program.
  const MemoryLimit limit(uint64_t(64) << 20);
  int refused = 0, total = 0;
  uint32_t seed = 0;
  const auto files = smallFiles();
  VdbReadOptions some;  // a later grid, in a tree of its own or not
  some.wanted = [](const openvdb::GridBase& grid) {
    return grid.getName() == "shared" || grid.getName() == "color";
  };
  const int mutations = mutationsPerFormat(4000) / int(files.size());
  for (const auto& [name, bytes] : files) {
    for (int round = 0; round < mutations; ++round) {
      std::mt19937 random(++seed);
      std::string changed = bytes;
      for (uint32_t i = 0, n = 1 + random() % 3; i < n; ++i) {
        // Half of the changes hit the header, the descriptors and the metadata.
        const size_t at = random() % (random() % 2 ? 1500 : changed.size());
        switch (random() % 6) {
          case 0:
            changed[at] = char(changed[at] ^ (1 << random() % 8));
            break;
          case 1:
            changed[at] = char(random());
            break;
          case 2:
            changed[at] = random() % 2 ? '\xff' : '\0';
            break;
          case 3: {
            const uint32_t word = random() % 2 ? 0xffffffffu : uint32_t(random());
            std::memcpy(&changed[std::min(at, changed.size() - 4)], &word, 4);
            break;
          }
          case 4:
            changed.insert(at, std::string(1 + random() % 8, char(random())));
            break;
          default:
            changed.erase(at, 1 + random() % 8);
        }
      }
      INFO(name << ", seed " << seed);
      overwriteFile(path, changed);
      const std::clock_t start = std::clock();
      const std::string error = errorOf(path), errorOfSome = errorOf(path, some);
      REQUIRE(double(std::clock() - start) < kMaxSeconds * double(CLOCKS_PER_SEC));
      ++total;
      if (!error.empty()) {
        ++refused;
        requireOneLineNaming(error, path);
      }
      if (!errorOfSome.empty()) requireOneLineNaming(errorOfSome, path);
    }
  }
  INFO(refused << " of " << total << " refused");
  CHECK(refused > total / 2);
}

TEST_CASE("vdb_file: a file beyond the limits is refused before it is loaded", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto write = [&](int level, const Coord& at) {
    const auto grid = MaskGrid::create();
    if (level < 0) {
      grid->tree().setValueOn(at);
    } else {
      grid->tree().addTile(openvdb::Index(level), at, true, true);
    }
    writeVdb(path, {grid});
  };
  const auto readable = [&](int64_t voxels, int coordinate) {
    const std::string error = errorOf(path, {voxels, coordinate, {}});
    if (!error.empty()) requireOneLineNaming(error, path);
    return error.empty();
  };
  // A voxel counts as its leaf.
  write(-1, Coord(9, 0, -100));
  CHECK(readable(512, 100));
  CHECK_FALSE(readable(511, 100));
  CHECK_FALSE(readable(512, 99));
  write(-1, Coord(100, 0, 0));
  CHECK(readable(512, 100));
  CHECK_FALSE(readable(512, 99));
  // Tiles count with all their voxels, and their last one.
  const int sides[] = {1, 8, 128, 4096};
  for (int level = 1; level <= 3; ++level) {
    INFO("level " << level);
    const int64_t side = sides[level], voxels = side * side * side;
    write(level, Coord(0));
    CHECK(readable(voxels, int(side) - 1));
    CHECK_FALSE(readable(voxels - 1, int(side) - 1));
    CHECK_FALSE(readable(voxels, int(side) - 2));
  }
  // By default a root tile is too much, and so is anything beyond 2^20.
  write(3, Coord(0));
  CHECK_FALSE(errorOf(path).empty());
  write(2, Coord(0));
  CHECK(errorOf(path).empty());
  write(-1, Coord(1 << 20, 0, -(1 << 20)));
  CHECK(errorOf(path).empty());
  for (const Coord& far : {Coord((1 << 20) + 1, 0, 0), Coord(0, -(1 << 20) - 1, 0),
                           Coord(0, 0, std::numeric_limits<int>::max()),
                           Coord(std::numeric_limits<int>::min(), 0, 0)}) {
    write(-1, far);
    CHECK_FALSE(errorOf(path).empty());
  }
}
