// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/slab_folder.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"

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
