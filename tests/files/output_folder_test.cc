// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_folder.h"

#include <filesystem>

#include "support/catch.h"
#include "support/files.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
namespace fs = std::filesystem;

TEST_CASE("output_folder: one that was made goes again unless it is kept", "[output_folder]") {
  const ScratchFolder scratch;
  {
    const OutputFolder folder(scratch / "new");
    CHECK(fs::is_directory(scratch / "new"));
    CHECK(folder.file("a.txt") == scratch / "new/a.txt");
  }
  CHECK_FALSE(fs::exists(scratch / "new"));
  OutputFolder(scratch / "new").keep();
  CHECK(fs::is_directory(scratch / "new"));
  { const OutputFolder there(scratch / "new"); }
  CHECK(fs::is_directory(scratch / "new"));
  {
    const OutputFolder used(scratch / "used");
    writeFile(used.file("a.txt"), "a");
  }
  CHECK(readFile(scratch / "used/a.txt") == "a");
}

TEST_CASE("output_folder: refused where there can be none", "[output_folder]") {
  const ScratchFolder scratch;
  writeFile(scratch / "file", "");
  for (const std::string name : {"file", "file/below", "none/below"}) {
    CHECK_THROWS_AS(OutputFolder(scratch / name), IoError);
    CHECK_THROWS_AS(checkOutputFolder(scratch / name), IoError);
  }
  for (const std::string name : {"", "new", "new/"})
    CHECK_NOTHROW(checkOutputFolder(scratch / name));
  CHECK(scratch.fileCount() == 1);  // checking makes nothing
}
