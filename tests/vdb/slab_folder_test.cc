// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder_writer.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/slab_folder.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// A folder of slabs, as far as its index goes.
void makeFolder(const std::string& path, const std::string& content) {
  std::filesystem::create_directory(path);
  std::ofstream(path + "/index.json") << "{\"format\": \"vdb_madf slabs\", \"" << content << "\"";
}

bool holds(const std::string& path, const std::string& content) {
  return readFile(path + "/index.json").find(content) != std::string::npos;
}

constexpr char kGone[] = ".replaced-99999999";  // no process has such a number

}  // namespace

TEST_CASE("slab_folder: what is written slab by slab is read as a whole", "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  const auto labels = Int32Grid::create();
  labels->setName("grain");
  {
    const SlabFolderWriter writer(path, {-8, 8, 32});
    for (const int slab : {1, 0}) {
      const auto part = Int32Grid::create();
      part->setName("grain");
      for (const Coord& voxel : {Coord(3, 4, 24 * slab - 5), Coord(9, -1, 24 * slab + 7)}) {
        part->tree().setValue(voxel, 1 + slab);
        labels->tree().setValue(voxel, 1 + slab);
      }
      writer.write(size_t(slab), {part});
      CHECK(part->metaCount() == labels->metaCount());
    }
    CHECK_FALSE(isSlabFolder(path));
    writer.commit(R"({"grains": 2, "version": "mine"})");
  }
  CHECK(folder.fileCount() == 1);
  CHECK(holds(path, "\"grains\": 2"));
  CHECK_FALSE(holds(path, "mine"));
  CHECK(openSlabFolder(path).cuts == std::vector<int>{-8, 8, 32});
  const auto grids = readVdb(path);
  REQUIRE(grids.size() == 1);
  const auto read = openvdb::gridPtrCast<Int32Grid>(grids[0]);
  CHECK(read->activeVoxelCount() == 4);
  for (auto voxel = labels->cbeginValueOn(); voxel; ++voxel)
    CHECK(read->tree().getValue(voxel.getCoord()) == *voxel);
}

TEST_CASE("slab_folder: without commit nothing is left", "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  {
    const SlabFolderWriter writer(path, {0, 8});
    writer.write(0, {Int32Grid::create()});
    CHECK_THROWS_AS(SlabFolderWriter(path, {0, 8}), IoError);  // another one is at work
    CHECK_THROWS_AS(writer.commit("[]"), InvalidInput);
  }
  CHECK(folder.fileCount() == 0);
  for (const std::vector<int>& cuts : {std::vector<int>{}, {0}, {0, 4}, {8, 0}, {0, 0}})
    CHECK_THROWS_AS(SlabFolderWriter(path, cuts), InvalidInput);
  std::filesystem::create_directory(path);
  CHECK_THROWS_AS(SlabFolderWriter(path, {0, 8}), IoError);
}

TEST_CASE("slab_folder: an index that is nested too deeply is refused", "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  constexpr size_t kDepth = 400000;
  std::filesystem::create_directory(path);
  std::ofstream(path + "/index.json") << "{\"format\": \"vdb_madf slabs\", \"slabs\": "
                                      << std::string(kDepth, '[') + std::string(kDepth, ']') + "}";
  CHECK_THROWS_AS(openSlabFolder(path), IoError);
}

TEST_CASE("slab_folder: a new folder takes the place of the old one", "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  makeFolder(folder / "first", "one");
  commitSlabFolder(folder / "first", path);
  CHECK(holds(path, "one"));
  makeFolder(folder / "second", "two");
  commitSlabFolder(folder / "second", path);
  CHECK(holds(path, "two"));
  CHECK(folder.fileCount() == 1);
  std::filesystem::create_directory(folder / "mine");
  CHECK_THROWS_AS(checkSlabFolder(folder / "mine"), IoError);
}

TEST_CASE("slab_folder: files of others and links are not replaced", "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  makeFolder(path, "mine");
  checkSlabFolder(path);
  std::filesystem::create_directory_symlink(path, folder / "link.slabs");
  CHECK_THROWS_WITH(checkSlabFolder(folder / "link.slabs"), Contains("it is a link"));
  std::ofstream(path + "/grains.csv") << "label";
  CHECK_THROWS_WITH(checkSlabFolder(path), Contains("it holds grains.csv, too"));
  makeFolder(folder / "made", "new");
  CHECK_THROWS_AS(commitSlabFolder(folder / "made", path), IoError);
  CHECK(holds(path, "mine"));
  CHECK(std::filesystem::exists(path + "/grains.csv"));
}

TEST_CASE("slab_folder: what a kill put aside goes away, or back if nothing took its place",
          "[slab_folder]") {
  const ScratchFolder folder;
  const std::string path = folder / "a.slabs";
  SECTION("after the new one came") {
    makeFolder(path, "new");
    makeFolder(path + kGone, "old");
    checkSlabFolder(path);
    CHECK(holds(path, "new"));
    CHECK(folder.fileCount() == 1);
  }
  SECTION("before") {
    makeFolder(path + kGone, "old");
    checkSlabFolder(path);
    CHECK(holds(path, "old"));
    CHECK(folder.fileCount() == 1);
  }
  SECTION("but not what a process works on, or what is something else") {
    makeFolder(path, "new");
    makeFolder(path + ".replaced-" + std::to_string(::getpid()), "old");
    makeFolder(path + ".replaced-", "mine");
    makeFolder(path + ".replaced-1x", "mine");
    makeFolder(folder / "b.slabs.replaced-99999999", "old");
    std::filesystem::create_directory(path + ".replaced-99999998");
    checkSlabFolder(path);
    CHECK(holds(path, "new"));
    CHECK(folder.fileCount() == 6);
  }
}
