// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_tree.h"

#include <filesystem>

#include "support/catch.h"
#include "support/files.h"
#include "support/full_disk.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;
namespace fs = std::filesystem;

TEST_CASE("output_tree: it appears with all its files, or leaves nothing", "[output_tree]") {
  const ScratchFolder scratch;
  for (const std::string end : {"", "/"}) {
    {
      OutputTree tree(scratch / "a.zarr" + end);
      tree.write("x", "1");
      tree.write("deep/er/y", std::string(3 << 20, 'y'));
      CHECK_FALSE(fs::exists(scratch / "a.zarr"));
    }
    CHECK(scratch.fileCount() == 0);
    OutputTree tree(scratch / "a.zarr" + end);
    tree.write("x", "1");
    tree.write("deep/er/y", std::string(3 << 20, 'y'));
    tree.write("deep/empty", "");
    tree.commit();
    CHECK(scratch.fileCount() == 1);
    CHECK(readFile(scratch / "a.zarr/x") == "1");
    CHECK(readFile(scratch / "a.zarr/deep/er/y") == std::string(3 << 20, 'y'));
    CHECK(readFile(scratch / "a.zarr/deep/empty").empty());
    fs::remove_all(scratch / "a.zarr");
  }
}

TEST_CASE("output_tree: nothing that is there is replaced", "[output_tree]") {
  const ScratchFolder scratch;
  writeFile(scratch / "file", "f");
  fs::create_directory(scratch / "used");
  writeFile(scratch / "used/mine", "m");
  fs::create_directory_symlink(scratch / "used", scratch / "link");
  fs::create_directory_symlink(scratch / "none", scratch / "broken");
  for (const std::string name : {"file", "used", "used/", "link", "broken"}) {
    CHECK_THROWS_WITH(OutputTree(scratch / name), Contains(scratch / "") && Contains("already"));
    CHECK_THROWS_WITH(checkOutputTree(scratch / name), Contains("already"));
  }
  for (const std::string name : {"none/below", "file/below", ""}) {
    CHECK_THROWS_AS(OutputTree(name.empty() ? name : scratch / name), IoError);
    CHECK_THROWS_AS(checkOutputTree(name.empty() ? name : scratch / name), IoError);
  }
  CHECK(readFile(scratch / "used/mine") == "m");
  fs::create_directory(scratch / "empty");
  CHECK_NOTHROW(checkOutputTree(scratch / "empty"));
  OutputTree tree(scratch / "empty");
  tree.write("x", "1");
  writeFile(scratch / "empty/late", "l");  // somebody else was faster
  CHECK_THROWS_AS(tree.commit(), IoError);
  CHECK(readFile(scratch / "empty/late") == "l");
}

TEST_CASE("output_tree: what a killed run left goes, a file that is there twice is refused",
          "[output_tree]") {
  const ScratchFolder scratch;
  const std::string left = scratch / ".a.zarr.999999999-0.tmp";
  fs::create_directories(left + "/deep");
  writeFile(left + "/deep/x", "x");
  checkOutputTree(scratch / "a.zarr/");
  CHECK(scratch.fileCount() == 0);
  OutputTree tree(scratch / "a.zarr");
  tree.write("x", "1");
  CHECK_THROWS_WITH(tree.write("x", "2"), Contains(scratch / "a.zarr/x"));
}

TEST_CASE("output_tree: a full disk is noticed", "[output_tree]") {
  const ScratchFolder scratch;
  {
    const FullDisk full(100);
    OutputTree tree(scratch / "a.zarr");
    tree.write("x", std::string(100, 'x'));
    CHECK_THROWS_WITH(tree.write("y", std::string(101, 'x')), Contains(scratch / "a.zarr/y"));
  }
  CHECK(scratch.fileCount() == 0);
}
