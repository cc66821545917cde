// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/input_file.h"

#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/files/read_text.h"

using namespace vdb_madf;
using detail::InputFile;
using vdb_madf::test::Contains;
using vdb_madf::test::TemporaryFolder;
using vdb_madf::test::writeBytes;

TEST_CASE("input_file: reads at any place, and no further than the end", "[input_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("in");
  writeBytes(path, "0123456789");
  const InputFile file(path);
  REQUIRE(file.size() == 10);
  REQUIRE(file.head(4) == "0123");
  REQUIRE(file.head(40) == "0123456789");
  std::string text(3, ' ');
  file.read(7, text.data(), 3);
  REQUIRE(text == "789");
  REQUIRE(file.readSome(8, text.data(), 3) == 2);
  REQUIRE(text == "899");
  REQUIRE(file.readSome(10, text.data(), 3) == 0);
  REQUIRE_THROWS_WITH(file.read(8, text.data(), 3), Contains(path) && Contains("at least 11"));
  REQUIRE_THROWS_AS(file.read(uint64_t(-1), text.data(), 3), IoError);
  std::filesystem::resize_file(path, 5);
  REQUIRE_THROWS_WITH(file.read(4, text.data(), 3), Contains("became shorter"));
}

TEST_CASE("input_file: a text is read whole, unless it is too long", "[input_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("in");
  writeBytes(path, "0123456789");
  CHECK(readText(path, 10) == "0123456789");
  CHECK_THROWS_WITH(readText(path, 9),
                    path + ": has 10 bytes, and a text of at most 9 is expected");
  writeBytes(path, "\xEF\xBB\xBFx\n\xEF\xBB\xBF");
  CHECK(readText(path, 10) == "x\n\xEF\xBB\xBF");
  writeBytes(path, "");
  CHECK(readText(path, 0).empty());
  CHECK_THROWS_AS(readText(folder.file("missing"), 9), IoError);
}

TEST_CASE("input_file: opens nothing but regular files, and does not wait for a pipe",
          "[input_file]") {
  const TemporaryFolder folder;
  const std::string pipe = folder.file("pipe");
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  REQUIRE_THROWS_WITH(InputFile(pipe), Contains(pipe + ": is not a regular file"));
  REQUIRE_THROWS_WITH(InputFile("/dev/zero"), Contains("is not a regular file"));
  REQUIRE_THROWS_WITH(InputFile(folder.path()), folder.path() + ": is a folder");
  const std::string missing = folder.file("missing");
  REQUIRE_THROWS_WITH(InputFile(missing),
                      missing + ": cannot be opened: No such file or directory");
  REQUIRE_THROWS_WITH(InputFile("scan.mhd", missing),
                      Contains("scan.mhd: its data file '") && Contains("No such file"));
}
