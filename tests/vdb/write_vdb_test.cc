// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Equal grids make equal bytes; what cannot be written leaves what was there.

#include "vdb_madf/vdb/write_vdb.h"

#include <openvdb/io/File.h>
#include <tbb/global_control.h>

#include <set>
#include <string>

#include "support/catch.h"
#include "support/full_disk.h"
#include "support/runs.h"
#include "support/same_grids.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/read_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("vdb_file: equal grids make equal bytes", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto make = [] {
    const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 20, "grain");
    setGraph(*labels, smallGraph());
    return Grids{labels, ballWithTiles<BoolGrid>(Coord(0), 9, "object"), noise(300)};
  };
  writeVdb(folder.file("first.vdb"), make());
  const std::string bytes = bytesOf(folder.file("first.vdb"));
  for (const int threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      size_t(threads));
    writeVdb(folder.file("again.vdb"), make());
    CHECK(bytesOf(folder.file("again.vdb")) == bytes);
    CHECK(vdbBytes("again.vdb", make()) == bytes);
  }
  // What was read is written the same again.
  const auto read = readVdb(folder.file("first.vdb"));
  writeVdb(folder.file("second.vdb"), Grids(read.begin(), read.end()));
  const std::string second = bytesOf(folder.file("second.vdb"));
  const auto readAgain = readVdb(folder.file("second.vdb"));
  writeVdb(folder.file("third.vdb"), Grids(readAgain.begin(), readAgain.end()));
  CHECK(bytesOf(folder.file("third.vdb")) == second);
}

TEST_CASE("vdb_file: the UUID is well formed and tells contents apart", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  std::set<std::string> uuids;
  for (int i = 0; i < 50; ++i) {
    const auto grid = ballWithTiles<Int32Grid>(Coord(0), 3, "grain");
    // One bit of a value, or of the topology.
    if (i % 2) grid->tree().setValueOnly(Coord(1, 0, 0), i);
    grid->tree().setActiveState(Coord(-30 - i, 0, 0), true);
    const std::string path = folder.file("a.vdb");
    writeVdb(path, {grid});
    const std::string uuid = bytesOf(path).substr(21, 36);
    REQUIRE(uuid.find_first_not_of("0123456789abcdef-") == std::string::npos);
    for (const int hyphen : {8, 13, 18, 23}) REQUIRE(uuid[size_t(hyphen)] == '-');
    REQUIRE(uuid[14] == '8');
    REQUIRE(std::string("89ab").find(uuid[19]) != std::string::npos);
    uuids.insert(uuid);
    openvdb::io::File file(path);
    file.open();
    REQUIRE(file.getUniqueTag() == uuid);
  }
  REQUIRE(uuids.size() == 50);
}

TEST_CASE("vdb_file: a full disk is noticed and leaves the old file", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto grid = noise(400);  // about 800 KiB
  writeVdb(path, {grid});
  const int64_t size = int64_t(std::filesystem::file_size(path));
  writeBytes(path, "old");
  for (const int64_t limit :
       {int64_t(0), int64_t(1), int64_t(40), int64_t(5000), size / 4, size / 2, size - 1}) {
    INFO("limit " << limit);
    std::string error;
    {
      const FullDisk disk{rlim_t(limit)};
      try {
        writeVdb(path, {grid});
      } catch (const IoError& caught) {
        error = caught.what();
      }
    }
    requireOneLineNaming(error, path);
    CHECK(bytesOf(path) == "old");
    CHECK(folder.entries() == 1);
  }
  {
    const FullDisk disk{rlim_t(size)};
    writeVdb(path, {grid});
  }
  CHECK(same(*grid, *readVdb(path).at(0)));
}

TEST_CASE("vdb_file: a place where no file can be is refused by name", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  writeBytes(folder.file("file"), "old");
  const auto refused = [](const std::string& path) {
    try {
      writeVdb(path, {noise(1)});
      FAIL("it was written");
    } catch (const IoError& error) {
      requireOneLineNaming(error.what(), path);
    }
  };
  refused(folder.file("missing/a.vdb"));
  refused(folder.file("file/a.vdb"));
  refused(folder.path());
  refused("/dev/full");
  CHECK(folder.entries() == 1);
  CHECK(bytesOf(folder.file("file")) == "old");
}

TEST_CASE("vdb_file: stops when interrupted, without a trace", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  writeBytes(path, "old");
  const Grids grids{noise(300, 1), noise(300, 2)};
  StopAfter never(1 << 30);
  writeVdb(folder.file("whole.vdb"), grids, &never);
  REQUIRE(never.asked >= 4);
  for (int question = 0; question < never.asked; ++question) {
    StopAfter stop(question);
    REQUIRE_THROWS_AS(writeVdb(path, grids, &stop), Interrupted);
    CHECK(bytesOf(path) == "old");
    CHECK(folder.entries() == 2);
  }
}
