// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Where outputs go: what is in the way is not lost, and what cannot be written is said.

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// The command fails, says what is in the way, and leaves all as it was.
void leavesAlone(const Bench& bench, const std::string& arguments, const std::string& file) {
  INFO("vdb_madf " << arguments);
  const auto before = bench.names();
  const std::string content = bench.bytes(file);
  const Outcome outcome = bench.run(arguments);
  CHECK(outcome.exitCode == 1);
  CHECK_THAT(outcome.err,
             vdb_madf::test::Contains(std::filesystem::path(file).filename().string()) &&
                 vdb_madf::test::Contains("choose another name"));
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
  CHECK_THAT(outcome.err, vdb_madf::test::Contains("grain_000077.stl"));
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

TEST_CASE("cli: no output where none can be, found out before the work", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  std::filesystem::create_directory(bench.path("d.vdb"));
  for (const std::string out : {"none/o.vdb", "d.vdb", "s.vdb/o.vdb"}) {
    refuses(bench, kFailed, "segment s.vdb " + out, {out});
    refuses(bench, kFailed, "convert s.vdb " + out, {out});
    refuses(bench, kFailed, "remerge g.vdb " + out, {out});
    refuses(bench, kFailed, kSpheres + out, {out});
  }
  refuses(bench, kFailed, "render g.vdb none/o.png", {"none/o.png"});
  refuses(bench, kFailed, "segment s.vdb o.vdb --json none/o.json", {"none/o.json"});
  refuses(bench, kFailed, "segment s.vdb o.vdb --json d.vdb", {"d.vdb"});
  refuses(bench, kFailed, "convert s.vdb none/o.raw", {"none/o.raw"});
  if (::geteuid() != 0) {  // nothing is read-only for root
    std::filesystem::create_directory(bench.path("locked"));
    ::chmod(bench.path("locked").c_str(), 0500);
    refuses(bench, kFailed, "segment s.vdb locked/o.vdb", {"locked/o.vdb"});
    ::chmod(bench.path("locked").c_str(), 0700);
  }
}

TEST_CASE("cli: the input is never overwritten, by whatever name", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 16 --length 6");
  bench.mustRun("generate snow m.mhd --size 16 --length 6");
  std::filesystem::create_symlink("s.vdb", bench.path("link.vdb"));
  std::filesystem::create_hard_link(bench.path("s.vdb"), bench.path("hard.vdb"));
  for (const std::string out : {"./s.vdb", "link.vdb", "hard.vdb"}) {
    refuses(bench, kWrongUsage, "segment s.vdb " + out, {out});
    refuses(bench, kWrongUsage, "convert s.vdb " + out, {out});
  }
  const std::string samples = bench.bytes("m.raw");
  refuses(bench, kFailed, "convert m.mhd m.raw --out-type int32", {"m.raw", "m.mhd"});
  refuses(bench, kFailed, "convert m.mhd m.raw --phase 1", {"m.raw", "m.mhd"});
  refuses(bench, kWrongUsage, "convert m.raw m.mhd --dims 16x16x16 --type uint8", {"m.raw"});
  CHECK(bench.bytes("m.raw") == samples);

  std::filesystem::create_directory(bench.path("slices"));
  bench.write("row.raw", std::string(8, '\1'));
  bench.mustRun("convert row.raw slices/0.tif --dims 8x1x1 --type uint8");
  bench.mustRun("convert row.raw slices/1.tif --dims 8x1x1 --type uint8");
  refuses(bench, kFailed, "convert slices slices/1.tif", {"slices/1.tif"});
  bench.mustRun("convert slices stack.tif");
}

TEST_CASE("cli: a full disk leaves nothing, and what was there before", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 64 --length 12");
  bench.mustRun("generate snow s.tif --size 64 --length 12");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  RunOptions full;
  full.largestFile = 4096;
  for (const std::string out : {"o.vdb", "o.raw", "o.tif", "o.mha", "o.mhd"}) {
    refuses(bench, kFailed, "convert s.vdb " + out, {"o."}, full);
    bench.write(out, "before");
    refuses(bench, kFailed, "convert s.vdb " + out + " --threshold 1", {"o."}, full);
    CHECK(bench.bytes(out) == "before");
  }
  refuses(bench, kFailed, "convert s.tif p.raw", {"p.raw"}, full);
  refuses(bench, kFailed, "segment s.vdb p.vdb --json j.json", {"p.vdb"}, full);
  refuses(bench, kFailed, "remerge g.vdb p.vdb", {"p.vdb"}, full);
  refuses(bench, kFailed, "generate snow p.vdb --size 64 --length 12", {"p.vdb"}, full);
  full.largestFile = 100;
  refuses(bench, kFailed, "render g.vdb p.png", {"p.png"}, full);
  refuses(bench, kFailed, "info g.vdb --json j.json",
          {"cannot write j.json: File too large; write it elsewhere"}, full);
}

TEST_CASE("cli: outputs that are in each other's way are refused before the work", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack s.slabs --dims 24x24x48 --radius 4:6 -q");
  bench.mustRun("convert s.slabs s.vdb");
  for (const std::string tables : {"o.vdb", "o.vdb/", "./o.vdb"}) {
    std::filesystem::remove(bench.path("o.vdb"));
    refuses(bench, kWrongUsage, "segment s.vdb o.vdb --tables " + tables,
            {"o.vdb: two outputs would go to this place"});
    bench.write("o.vdb", "before");
    refuses(bench, kWrongUsage, "segment s.vdb o.vdb --tables " + tables, {"o.vdb: two outputs"});
    CHECK(bench.bytes("o.vdb") == "before");
  }
  refuses(bench, kWrongUsage, "segment s.vdb p.vdb --tables j --json j", {"j: two outputs"});
  const std::string slab = bench.bytes("s.slabs/slab-0000.vdb");
  for (const std::string output : {"s.slabs/slab-0000.vdb", "s.slabs/new.tif", "./s.slabs/o.npy"})
    refuses(bench, kWrongUsage, "convert s.slabs " + output, {"among the slabs of the input"});
  CHECK(bench.bytes("s.slabs/slab-0000.vdb") == slab);
}

TEST_CASE("cli: an input does not go with the slabs that it lies among", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack s.slabs --dims 24x24x48 --radius 4:6 -q");
  bench.mustRun("convert s.slabs s.vdb");
  bench.mustRun("segment s.slabs g.slabs -q");
  const std::string slab = "g.slabs/slab-0000.vdb", guess = "g.slabs/.guess.txt";
  std::filesystem::create_symlink(slab, bench.path("link.vdb"));
  std::filesystem::create_symlink(".", bench.path("here"));
  bench.write(guess, "1 0 0 0  0 1 0 0  0 0 1 0");
  const std::string content = bench.bytes(slab);
  for (const std::string& run :
       {"segment " + slab + " g.slabs", "segment " + slab + " here/g.slabs/",
        std::string("segment link.vdb g.slabs"), "segment s.vdb g.slabs --roi " + slab,
        "remerge " + slab + " g.slabs", "track " + slab + " s.vdb g.slabs",
        "track s.vdb " + slab + " g.slabs", "track s.vdb s.vdb g.slabs --motion " + guess,
        "track " + slab + " s.vdb other/g.slabs here --motion rigid"})
    refuses(bench, kWrongUsage, run, {"g.slabs: replaces the slabs that are there", "among them"});
  CHECK(bench.bytes(slab) == content);
  CHECK(bench.bytes(guess) != "");

  std::filesystem::rename(bench.path("g.slabs"), bench.path("g.slabs.part"));
  const std::string part = "segment g.slabs.part/slab-0000.vdb g.slabs --resume";
  refuses(bench, kWrongUsage, part, {"among them"});
  std::filesystem::rename(bench.path("g.slabs.part"), bench.path("g.slabs"));
  bench.mustRun("segment s.slabs g.slabs -q");
}

TEST_CASE("cli: a plot on standard output is nothing but the plot", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 24 --length 8");
  const std::string sweep = "sweep s.vdb s.csv --strictness 9:11:1 --plot ";
  const std::string plot = bench.mustRun(sweep + "-");
  bench.mustRun(sweep + "s.svg");
  CHECK(plot == bench.bytes("s.svg"));
}

TEST_CASE("cli: a standard output that takes nothing is an error", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 16 --length 6");
  bench.mustRun("segment s.vdb g.vdb");
  RunOptions full;
  full.out = "/dev/full";
  for (const std::string arguments :
       {"--help", "segment --help", "--version", "info s.vdb", "compare g.vdb g.vdb",
        "compare g.vdb g.vdb --json -", "segment s.vdb g.vdb", "render g.vdb g.png",
        "info s.vdb --json /dev/full"}) {
    CAPTURE(arguments);
    const Outcome outcome = bench.run(arguments, full);
    CHECK(outcome.exitCode == kFailed);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  }
}
