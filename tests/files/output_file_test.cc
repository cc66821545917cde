// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/output_file.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <iterator>
#include <set>
#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using vdb_madf::test::bytesOf;
using vdb_madf::test::TemporaryFolder;
using vdb_madf::test::writeBytes;

namespace {

/// The error of making an output there; empty if there is none.
std::string errorOf(const std::string& path) {
  try {
    const OutputFile output(path);
    return {};
  } catch (const IoError& error) {
    return error.what();
  }
}

void requireErrorNames(const std::string& path) {
  INFO(path);
  const std::string error = errorOf(path);
  REQUIRE(error.find(path) != std::string::npos);
  REQUIRE(error.find('\n') == std::string::npos);
}

}  // namespace

TEST_CASE("output_file: appears when committed, not before", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  {
    OutputFile output(path);
    REQUIRE(output.path() == path);
    writeBytes(output.temporaryPath(), "new");
    REQUIRE_FALSE(std::filesystem::exists(path));
    output.commit();
    REQUIRE(bytesOf(path) == "new");
    REQUIRE(folder.entries() == 1);
  }
  REQUIRE(bytesOf(path) == "new");
}

TEST_CASE("output_file: without a commit nothing changes", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  writeBytes(path, "old");
  {
    const OutputFile output(path);
    writeBytes(output.temporaryPath(), "new");
    REQUIRE(folder.entries() == 2);
  }
  REQUIRE(bytesOf(path) == "old");
  REQUIRE(folder.entries() == 1);
}

TEST_CASE("output_file: replaces an existing file", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  writeBytes(path, "old");
  OutputFile output(path);
  writeBytes(output.temporaryPath(), "new");
  output.commit();
  REQUIRE(bytesOf(path) == "new");
  REQUIRE(folder.entries() == 1);
}

TEST_CASE("output_file: has the permissions of an ordinary new file", "[output_file]") {
  const TemporaryFolder folder;
  const mode_t before = ::umask(0);
  for (const mode_t mask : {0022u, 0077u, 0002u}) {
    ::umask(mask);
    const std::string path = folder.file("out" + std::to_string(mask));
    OutputFile(path).commit();
    struct stat status {};
    REQUIRE(::stat(path.c_str(), &status) == 0);
    CHECK((status.st_mode & 0777) == (0666 & ~mask));
  }
  ::umask(before);
}

TEST_CASE("output_file: two of the same path do not meet", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out.txt");
  OutputFile first(path), second(path);
  REQUIRE(first.temporaryPath() != second.temporaryPath());
  writeBytes(first.temporaryPath(), "first");
  writeBytes(second.temporaryPath(), "second");
  first.commit();
  second.commit();
  REQUIRE(bytesOf(path) == "second");
}

TEST_CASE("output_file: takes the longest of names, and a name without a folder", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string(255, 'n'));
  OutputFile(path).commit();
  REQUIRE(std::filesystem::exists(path));

  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  OutputFile("short").commit();
  std::filesystem::current_path(before);
  REQUIRE(std::filesystem::exists(folder.file("short")));
  REQUIRE(folder.entries() == 2);
}

TEST_CASE("output_file: says at once where no file can be", "[output_file]") {
  const TemporaryFolder folder;
  writeBytes(folder.file("file"), "");
  requireErrorNames(folder.file("missing/out.vdb"));
  requireErrorNames(folder.file("file/out.vdb"));
  requireErrorNames(folder.path());
  requireErrorNames(folder.path() + "/");
  requireErrorNames(folder.file(std::string(256, 'n')));
  REQUIRE_FALSE(errorOf("").empty());
  REQUIRE(folder.entries() == 1);
}

TEST_CASE("output_file: replaces nothing but regular files", "[output_file]") {
  requireErrorNames("/dev/null");
  const TemporaryFolder folder;
  const std::string link = folder.file("link");
  REQUIRE(::symlink("/dev/null", link.c_str()) == 0);
  requireErrorNames(link);
}

TEST_CASE("output_file: replaces what a link points to, not the link", "[output_file]") {
  const TemporaryFolder folder, other;
  writeBytes(other.file("real"), "old");
  const std::string link = folder.file("link");
  REQUIRE(::symlink(other.file("real").c_str(), link.c_str()) == 0);
  {
    OutputFile file(link);
    writeBytes(file.temporaryPath(), "new");
    file.commit();
  }
  REQUIRE(std::filesystem::is_symlink(link));
  REQUIRE(bytesOf(other.file("real")) == "new");
  REQUIRE(folder.entries() == 1);
  REQUIRE(other.entries() == 1);
}

TEST_CASE("output_file: makes what a dead link points to", "[output_file]") {
  const TemporaryFolder folder, other;
  const std::string link = folder.file("link");
  REQUIRE(::symlink("second", link.c_str()) == 0);
  REQUIRE(::symlink(other.file("new").c_str(), folder.file("second").c_str()) == 0);
  {
    OutputFile file(link);
    CHECK(file.temporaryPath().find(other.path()) == 0);
    writeBytes(file.temporaryPath(), "new");
    file.commit();
  }
  CHECK(std::filesystem::is_symlink(link));
  CHECK(std::filesystem::is_symlink(folder.file("second")));
  CHECK(bytesOf(other.file("new")) == "new");
  CHECK(folder.entries() == 2);
  CHECK(other.entries() == 1);

  REQUIRE(::symlink("circle", folder.file("circle").c_str()) == 0);
  requireErrorNames(folder.file("circle"));
  REQUIRE(::symlink("/missing/folder/file", folder.file("nowhere").c_str()) == 0);
  requireErrorNames(folder.file("nowhere"));
}

TEST_CASE("output_file: what killed programs left of a file is removed", "[output_file]") {
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  REQUIRE(gone > 0);
  REQUIRE(::waitpid(gone, nullptr, 0) == gone);
  const std::string dead = std::to_string(gone), alive = std::to_string(::getppid());
  const TemporaryFolder folder, other;
  const std::string left[] = {".out.vdb." + dead + "-0.tmp", ".out.vdb." + dead + "-17.tmp"};
  const std::string others[] = {".out.vdb." + alive + "-0.tmp",
                                ".out.vdb." + std::to_string(::getpid()) + "-0.tmp",
                                ".out." + dead + "-0.tmp",
                                ".my.out.vdb." + dead + "-0.tmp",
                                "out.vdb." + dead + "-0.tmp",
                                ".out.vdb." + dead + ".tmp",
                                ".out.vdb." + dead + "-0.tmp.txt",
                                ".out.vdb." + dead + "-00.tmp",
                                ".out.vdb.0-0.tmp",
                                ".out.vdb.-1-0.tmp",
                                ".out.vdb.text-0.tmp",
                                ".tmp"};
  for (const std::string& name : left) writeBytes(folder.file(name), "half a file");
  for (const std::string& name : others) writeBytes(folder.file(name), "another's");
  writeBytes(other.file(left[0]), "half a file");
  REQUIRE(::symlink(other.file("out.vdb").c_str(), folder.file("linked").c_str()) == 0);
  removeLeftovers({folder.file("out.vdb"), folder.file("linked"), "/missing/file", ""});
  CHECK(folder.entries() == int(std::size(others)) + 1);
  for (const std::string& name : others) {
    CAPTURE(name);
    CHECK(std::filesystem::exists(folder.file(name)));
  }
  CHECK(other.entries() == 0);
}

TEST_CASE("output_file: respects permissions", "[output_file]") {
  if (::geteuid() == 0) {
    WARN("skipped: permissions do not bind root");
    return;
  }
  const TemporaryFolder folder;
  writeBytes(folder.file("protected"), "old");
  REQUIRE(::chmod(folder.file("protected").c_str(), 0444) == 0);
  requireErrorNames(folder.file("protected"));
  REQUIRE(::chmod(folder.path().c_str(), 0555) == 0);
  requireErrorNames(folder.file("out.vdb"));
  REQUIRE(::chmod(folder.path().c_str(), 0755) == 0);
  REQUIRE(bytesOf(folder.file("protected")) == "old");
}

TEST_CASE("output_file: a commit that fails leaves nothing behind", "[output_file]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out");
  {
    OutputFile output(path);
    // Something else came to be there in the meantime.
    std::filesystem::create_directory(path);
    try {
      output.commit();
      FAIL("it was committed");
    } catch (const IoError& error) {
      REQUIRE(std::string(error.what()).find(path) != std::string::npos);
    }
  }
  REQUIRE(std::filesystem::is_directory(path));
  REQUIRE(folder.entries() == 1);
}
