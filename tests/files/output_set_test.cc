// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_set.h"

#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/output_file.h"

using namespace vdb_madf;
using vdb_madf::test::bytesOf;
using vdb_madf::test::TemporaryFolder;
using vdb_madf::test::writeBytes;
namespace fs = std::filesystem;

namespace {

void writeInSet(const std::string& path, const std::string& bytes) {
  OutputFile file(path);
  writeBytes(file.temporaryPath(), bytes);
  file.commit();
}

}  // namespace

TEST_CASE("output_set: files wait for each other", "[output_set]") {
  const TemporaryFolder folder;
  const std::string a = folder.file("a"), b = folder.file("b");
  writeBytes(a, "old");
  {
    OutputSet set;
    {
      OutputSet inner;
      writeInSet(a, "new");
      inner.commit();
    }
    writeInSet(b, "new");
    CHECK(bytesOf(a) == "old");
    CHECK_FALSE(fs::exists(b));
    set.commit();
  }
  CHECK(bytesOf(a) == "new");
  CHECK(bytesOf(b) == "new");
  CHECK(folder.entries() == 2);
  writeInSet(a, "alone");
  CHECK(bytesOf(a) == "alone");
}

TEST_CASE("output_set: without a commit nothing changes", "[output_set]") {
  const TemporaryFolder folder;
  writeBytes(folder.file("a"), "old");
  {
    const OutputSet set;
    writeInSet(folder.file("a"), "new");
    OutputSet inner;
    writeInSet(folder.file("b"), "new");
    inner.commit();
  }
  CHECK(bytesOf(folder.file("a")) == "old");
  CHECK(folder.entries() == 1);
}

TEST_CASE("output_set: if one file cannot be replaced, none is", "[output_set]") {
  const TemporaryFolder folder;
  writeBytes(folder.file("a"), "old");
  {
    OutputSet set;
    writeInSet(folder.file("a"), "new");
    writeInSet(folder.file("b"), "new");
    writeInSet(folder.file("c"), "new");
    fs::create_directory(folder.file("c"));  // comes between
    CHECK_THROWS_AS(set.commit(), IoError);
  }
  CHECK(bytesOf(folder.file("a")) == "old");
  CHECK_FALSE(fs::exists(folder.file("b")));
  CHECK(folder.entries() == 2);
}

TEST_CASE("output_set: the next run puts back what a killed one had replaced", "[output_set]") {
  const std::string end("\0", 1);
  for (const bool isWhole : {true, false}) {  // the journal
    CAPTURE(isWhole);
    const TemporaryFolder folder;
    // As a process of this number would; it is beyond the largest number of a process.
    writeBytes(folder.file("a"), "new");
    writeBytes(folder.file(".a.2000000000-2.tmp"), "old");
    writeBytes(folder.file("b"), "new");
    writeBytes(folder.file(".c.2000000000-1.tmp"), "half");
    const std::string set = "a" + end + ".a.2000000000-2.tmp" + end + "b" + end + end;
    writeBytes(folder.file(".a.2000000000-3.undo"), isWhole ? set + "end" + end : set);
    removeLeftovers({folder.file("b"), folder.file("a")});
    CHECK(bytesOf(folder.file("a")) == (isWhole ? "old" : "new"));
    CHECK(fs::exists(folder.file("b")) == !isWhole);
    CHECK(fs::exists(folder.file(".c.2000000000-1.tmp")));
    CHECK(folder.entries() == (isWhole ? 2 : 3));
  }
}
