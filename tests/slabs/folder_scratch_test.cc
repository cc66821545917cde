// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/folder_scratch.h"

#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/files.h"
#include "support/full_disk.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// Numbers as they are in scratch: runs, with noise between; not a whole number of words.
Bytes someBytes(size_t size) {
  Bytes bytes(size);
  uint32_t state = 1;
  for (size_t i = 0; i < size; ++i) {
    state = state * 1664525 + 1013904223;
    bytes[i] = char(i / 1000 % 3 == 0 ? state >> 24 : i / 4000);
  }
  return bytes;
}

}  // namespace

TEST_CASE("folder scratch: gives back what it got", "[scratch]") {
  const ScratchFolder folder;
  FolderScratch scratch(folder / "scratch", "work", false);
  for (const size_t size : {size_t(0), size_t(1), size_t(13), size_t(100000), size_t(9000001)}) {
    const Bytes bytes = someBytes(size);
    scratch.write("piece", bytes);
    CHECK(scratch.has("piece"));
    CHECK(scratch.read("piece") == bytes);
  }
  scratch.write("zeros", Bytes(size_t(64) << 20, '\0'));
  CHECK(scratch.read("zeros") == Bytes(size_t(64) << 20, '\0'));
  scratch.remove("piece");
  CHECK_FALSE(scratch.has("piece"));
  CHECK_THROWS_AS(scratch.read("piece"), IoError);
  scratch.removeAll();
  CHECK_FALSE(std::filesystem::exists(folder / "scratch"));
}

TEST_CASE("folder scratch: goes on with the same work alone", "[scratch]") {
  const ScratchFolder folder;
  const std::string path = folder / "scratch";
  { FolderScratch(path, "this work", false).write("a", someBytes(100)); }
  writeFile(path + "/.a.piece.999999-0.tmp", "half");
  CHECK_THROWS_WITH(FolderScratch(path, "this work", false), vdb_madf::test::Contains("resume it"));
  CHECK_THROWS_WITH(FolderScratch(path, "other work", true),
                    vdb_madf::test::Contains("other options"));
  CHECK(FolderScratch(path, "this work", true).read("a") == someBytes(100));
  CHECK_FALSE(std::filesystem::exists(path + "/.a.piece.999999-0.tmp"));
  // Killed before it was known whose it is.
  std::filesystem::create_directory(folder / "early");
  writeFile(folder / "early" + "/.work.piece.999999-0.tmp", "half");
  CHECK_FALSE(FolderScratch(folder / "early", "work", false).has("a"));
  CHECK_FALSE(std::filesystem::exists(folder / "early" + "/.work.piece.999999-0.tmp"));
  // A folder of something else.
  std::filesystem::create_directory(folder / "photos");
  writeFile((folder / "photos") + "/me.jpg", "x");
  CHECK_THROWS_AS(FolderScratch(folder / "photos", "this work", false), IoError);
  CHECK_THROWS_WITH(FolderScratch(folder / "photos", "this work", true),
                    vdb_madf::test::Contains("no folder of scratch data"));
  CHECK(readFile((folder / "photos") + "/me.jpg") == "x");
  {
    const FolderScratch first(folder / "two", "work", false);
    CHECK_THROWS_WITH(FolderScratch(folder / "two/", "work", true),
                      vdb_madf::test::Contains("another run"));
  }
  FolderScratch again((folder / "two") + "/", "work", true);
  again.removeAll();
  CHECK_FALSE(std::filesystem::exists(folder / "two"));
  CHECK_THROWS_AS(FolderScratch((folder / "none") + "/scratch", "work", false), IoError);
}

TEST_CASE("folder scratch: leaves nothing where it cannot begin", "[scratch]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "there");
  {
    const FullDisk full(16);
    for (const std::string& path : {folder / "new", folder / "there"})
      CHECK_THROWS_AS(FolderScratch(path, "work", false), IoError);
  }
  CHECK_FALSE(std::filesystem::exists(folder / "new"));
  CHECK(std::filesystem::is_empty(folder / "there"));
  // What another run left stays.
  { FolderScratch(folder / "there", "work", false).write("a", someBytes(100)); }
  CHECK_THROWS_AS(FolderScratch(folder / "there", "work", false), IoError);
  CHECK(FolderScratch(folder / "there", "work", true).read("a") == someBytes(100));
}

TEST_CASE("folder scratch: damage is noticed wherever it is", "[scratch]") {
  const ScratchFolder folder;
  FolderScratch scratch(folder / "scratch", "work", false);
  scratch.write("piece", someBytes(30000));
  const std::string path = scratch.file("piece.piece"), good = readFile(path);
  for (size_t i = 0; i < good.size(); i += i < 200 ? 1 : 97) {
    std::string bad = good;
    bad[i] = char(bad[i] ^ 0x41);
    writeFile(path, bad);
    CHECK_THROWS_AS(scratch.read("piece"), IoError);
  }
  for (size_t size = 0; size < good.size(); size += size < 200 ? 7 : 997) {
    writeFile(path, good.substr(0, size));
    CHECK_THROWS_AS(scratch.read("piece"), IoError);
  }
  writeFile(path, good);
  CHECK(scratch.read("piece") == someBytes(30000));
}

TEST_CASE("folder scratch: is shared by those who take part, and by no others", "[scratch]") {
  const ScratchFolder folder;
  const std::string path = folder / "scratch";
  CHECK_THROWS_WITH((FolderScratch(path)), vdb_madf::test::Contains("is not there for all"));
  FolderScratch first(path, "work", false);
  CHECK_FALSE(first.isShared());
  CHECK_THROWS_WITH((FolderScratch(path)), vdb_madf::test::Contains("another run"));
  first.share();
  {
    FolderScratch second(path);
    CHECK(first.isShared());
    CHECK(second.isShared());
    second.write("a", someBytes(100));
    CHECK(first.read("a") == someBytes(100));
    first.remove("a");
    CHECK_FALSE(second.has("a"));
    CHECK_THROWS_WITH(FolderScratch(path, "work", true), vdb_madf::test::Contains("another run"));
  }
  CHECK_THROWS_WITH(FolderScratch(path, "work", true), vdb_madf::test::Contains("another run"));
}
