// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/files/detail/output_stream.h"

#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using detail::OutputStream;
using vdb_madf::test::bytesOf;
using vdb_madf::test::Contains;
using vdb_madf::test::FullDisk;
using vdb_madf::test::TemporaryFolder;

TEST_CASE("output_stream: pieces of any size stay in order", "[output_stream]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out");
  std::string expected;
  OutputStream out(path);
  // Less than, about as much as, and more than the buffer holds.
  for (const size_t count : {1, 7, 1 << 20, 3, 1 << 21, (1 << 20) - 3, 5, 0, 1 << 19, 1 << 19, 1}) {
    const std::string piece(count, char('a' + expected.size() % 26));
    out.text(piece);
    expected += piece;
  }
  out.value(int16_t(0x4241));
  out.number(0.25);
  expected += "AB0.25";
  REQUIRE_FALSE(std::filesystem::exists(path));
  out.close();
  REQUIRE_FALSE(std::filesystem::exists(path));
  out.commit();
  REQUIRE(bytesOf(path) == expected);
  REQUIRE(folder.entries() == 1);
}

TEST_CASE("output_stream: writes and reads back at any place", "[output_stream]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out");
  OutputStream out(path);
  out.writeAt(4, "efgh", 4);
  REQUIRE(out.size() == 8);
  out.writeAt(0, "abcd", 4);
  REQUIRE(out.size() == 8);
  std::string text(4, ' ');
  REQUIRE(out.readAt(2, text.data(), 4) == 4);
  REQUIRE(text == "cdef");
  REQUIRE(out.readAt(6, text.data(), 4) == 2);
  REQUIRE(text == "ghef");
  out.resize(6);
  REQUIRE(out.size() == 6);
  out.resize(7);
  REQUIRE(out.size() == 7);
  out.commit();
  REQUIRE(bytesOf(path) == std::string("abcdef\0", 7));
}

TEST_CASE("output_stream: a full disk is noticed and leaves nothing behind", "[output_stream]") {
  const TemporaryFolder folder;
  const std::string path = folder.file("out");
  {
    const FullDisk disk{5000};
    OutputStream out(path);
    out.text(std::string(6000, 'a'));
    REQUIRE_THROWS_WITH(out.commit(), Contains("cannot write " + path));
  }
  REQUIRE(folder.entries() == 0);
}

TEST_CASE("output_stream: an interrupt is seen when the buffer is written", "[output_stream]") {
  struct Stop : Interrupter {
    bool wasInterrupted(int) override { return true; }
  } stop;
  const TemporaryFolder folder;
  {
    OutputStream out(folder.file("out"), &stop);
    out.text("a");
    REQUIRE_THROWS_AS(out.close(), Interrupted);
  }
  REQUIRE(folder.entries() == 0);
}
