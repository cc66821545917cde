// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What happens to files that are there already.

#include <catch2/catch.hpp>
#include <filesystem>

#include "support/program.h"

using namespace vdb_madf::test;

namespace {

/// The command fails, says what is in the way, and leaves all as it was.
void leavesAlone(const Bench& bench, const std::string& arguments, const std::string& file) {
  INFO("vdb_madf " << arguments);
  const auto before = bench.names();
  const std::string content = bench.bytes(file);
  const Outcome outcome = bench.run(arguments);
  CHECK(outcome.exitCode == 1);
  CHECK_THAT(outcome.err, Catch::Contains(std::filesystem::path(file).filename().string()) &&
                              Catch::Contains("choose another name"));
  CHECK(bench.bytes(file) == content);
  CHECK(bench.names() == before);
}

}  // namespace

TEST_CASE("cli: an .mhd replaces no .raw but its own", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow a.tif --size 16 --length 6");
  bench.write("b.raw", "the only scan");
  for (const std::string verb : {"convert a.tif", "generate snow --size 16 --length 6"})
    leavesAlone(bench, verb + " b.mhd", "b.raw");
  bench.write("b.mhd", "ObjectType = Image\nElementDataFile = other.raw\n");
  leavesAlone(bench, "convert a.tif b.mhd", "b.raw");
  bench.write("b.mhd", "no header");
  leavesAlone(bench, "convert a.tif b.mhd", "b.raw");

  bench.mustRun("convert a.tif c.mhd");
  const std::string samples = bench.bytes("c.raw");
  bench.mustRun("convert a.tif c.mhd --invert");
  CHECK(bench.bytes("c.raw") != samples);
  bench.mustRun("convert a.tif c.mhd");
  CHECK(bench.bytes("c.raw") == samples);
}

TEST_CASE("cli: generate replaces no truth but its own", "[cli]") {
  const Bench bench;
  const std::string sintered = "generate sintered --size 40 --count 4 --radius 6:9 ";
  bench.write("a.truth.tif", "labels by hand");
  leavesAlone(bench, sintered + "a.tif", "a.truth.tif");
  bench.mustRun("generate snow --size 16 --length 6 a.tif");  // has no truth to write
  CHECK(bench.bytes("a.truth.tif") == "labels by hand");
  bench.mustRun(sintered + "b.tif");
  const std::string truth = bench.bytes("b.truth.tif");
  bench.mustRun(sintered + "b.tif --seed 2");
  CHECK(bench.bytes("b.truth.tif") != truth);
}

TEST_CASE("cli: tables replace a whole set of tables only", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 32 --count 2 --radius 4:6");
  bench.mustRun("segment s.vdb g.vdb");
  for (const std::string name : {"grains.csv", "bonds.csv", "sample.json"}) {
    const std::string folder = "of_" + name;
    std::filesystem::create_directory(bench.path(folder));
    bench.write(folder + "/" + name, "measured otherwise");
    leavesAlone(bench, "measure g.vdb " + folder, folder + "/" + name);
    leavesAlone(bench, "segment s.vdb h.vdb --tables " + folder, folder + "/" + name);
  }
  bench.mustRun("measure g.vdb tables");
  bench.mustRun("measure g.vdb tables");
}

TEST_CASE("cli: a folder of meshes holds the grains of one sample", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 32 --count 2 --radius 4:6");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("export g.vdb meshes --as mesh");
  bench.mustRun("export g.vdb meshes --as mesh");
  bench.write("meshes/notes.txt", "");
  bench.write("meshes/grain_of_salt.stl", "");
  bench.mustRun("export g.vdb meshes --as mesh");
  bench.write("meshes/grain_000077.stl", "of another sample");
  const Outcome outcome = bench.run("export g.vdb meshes --as mesh");
  CHECK(outcome.exitCode == 1);
  CHECK_THAT(outcome.err, Catch::Contains("grain_000077.stl"));
}

TEST_CASE("cli: what a killed run left goes with the next run that writes there", "[cli]") {
  const Bench bench;
  // As a process of this number would name it; it is beyond the largest number of a process.
  const std::string left = ".a.tif.2000000000-0.tmp", log = ".log.json.2000000000-1.tmp";
  for (const std::string& name : {left, log}) bench.write(name, "half a file");
  bench.mustRun("generate snow a.tif --size 16 --length 6");
  CHECK(bench.names() == std::set<std::string>{"a.tif", log});
  bench.mustRun("info a.tif --json log.json");
  CHECK(bench.names() == std::set<std::string>{"a.tif", "log.json"});
}

TEST_CASE("cli: outputs go through links, to be or there", "[cli]") {
  const Bench bench;
  std::filesystem::create_directory(bench.path("real"));
  for (const std::string name : {"a.tif", "g.vdb", "g.ply", "g.json", "p.png"})
    std::filesystem::create_symlink("real/" + name, bench.path(name));
  for (int run = 0; run < 2; ++run) {
    bench.mustRun("generate snow a.tif --size 24 --length 8");
    bench.mustRun("segment a.tif g.vdb --json g.json");
    bench.mustRun("export g.vdb g.ply");
    bench.mustRun("render g.vdb p.png");
    for (const std::string name : {"a.tif", "g.vdb", "g.ply", "g.json", "p.png"}) {
      CAPTURE(run, name);
      CHECK(std::filesystem::is_symlink(bench.path(name)));
      CHECK(std::filesystem::is_regular_file(bench.path("real/" + name)));
    }
  }
}
