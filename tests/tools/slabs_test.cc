// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// `segment IN OUT.slabs`: a folder of slabs, with the labels of one file.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <random>
#include <string>

#include "support/catch.h"
#include "support/refusals.h"
#include "support/slab_runs.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

TEST_CASE("slabs: one file of them is the one that segment writes", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8um -q");
  for (const std::string options :
       {"", "--boundary closed --tidy 0", "--paper", "--fill-holes 1000 --merge neck --tidy 9",
        "--merge both --min-grain 999", "--strictness 9 --fill-holes 1000 --min-grain 999",
        "--merge both --theta -1 --delta 0 --crop 3,3,5:35,30,71",
        "--roi cylinder:z:20,16:14 --gamma 9"}) {
    INFO(options);
    const std::string choice = " --grid object -q " + options;
    bench.mustRun("segment in.vdb one.vdb" + choice);
    for (const std::string cut :
         {"--slab-height 16", "--slab-height 39", "--max-memory 300MiB --threads 1"}) {
      bench.mustRun("segment in.vdb out.slabs " + cut + choice);
      requireSame(bench);
    }
  }
  CHECK_FALSE(bench.names().count("out.slabs.part"));
}

TEST_CASE("slabs: images are read layer by layer", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8x8x20um -q");
  bench.mustRun("convert in.vdb --grid object in.tif -q");
  bench.mustRun("convert in.vdb --grid object gray.npy --type uint8 -q");
  for (const std::string input :
       {"in.tif", "in.tif --invert", "gray.npy --smooth 1 --threshold 0.4 --voxel-size 3um",
        "gray.npy --smooth 1 --range 0.3:0.6 --crop 0,2,8:39,30,71", "in.tif --crop 0,0,8:39,32,80",
        "in.tif --despeckle 30"}) {
    INFO(input);
    bench.mustRun("segment " + input + " one.vdb -q");
    bench.mustRun("segment " + input + " out.slabs --slab-height 24 -q");
    requireSame(bench);
  }
}

TEST_CASE("slabs: what does not fit becomes one file all the same, if that is asked for",
          "[slabs]") {
  const Bench bench;
  // A voxel in each of some 83,000 leaf nodes: they take 210 MiB as a whole.
  constexpr int kWidth = 8 * 34, kHeight = 8 * 72;
  std::string voxels(size_t(kWidth) * kWidth * kHeight, '\0');
  for (size_t z = 3; z < kHeight; z += 8)
    for (size_t y = 4; y < kWidth; y += 8)
      for (size_t x = z / 100; x < kWidth; x += 8) voxels[(z * kWidth + y) * kWidth + x] = 1;
  bench.write("in.raw", voxels);
  const std::string in = "segment in.raw ", how = " --dims 272x272x576 --type uint8 --phase 1 -q";
  bench.mustRun(in + "one.vdb" + how);
  const Outcome refused = bench.run(in + "out.vdb --max-memory 200MiB" + how);
  CHECK(refused.exitCode == 1);
  CHECK_THAT(refused.err,
             Contains("(--max-memory), or work in slabs") && Contains("out.vdb.slabs"));
  CHECK_FALSE(bench.names().count("out.vdb"));
  const std::string automatic = " --auto-slabs --max-memory 200MiB --json out.json" + how;
  bench.mustRun(in + "out.vdb" + automatic);
  CHECK(bench.bytes("out.vdb") == bench.bytes("one.vdb"));
  const Json json = Json::parse(bench.bytes("out.json"));
  CHECK(json.at("output") == "out.vdb");
  CHECK(json.at("slab_count") > 0);
  CHECK_THAT(json.at("notes").dump(), Contains("works in slabs"));
  bench.mustRun(in + "out.raw" + automatic);
  bench.mustRun("convert one.vdb one.raw -q");
  CHECK(bench.bytes("out.raw") == bench.bytes("one.raw"));
  for (const std::string& name : bench.names()) CHECK(name.find(".slabs") == std::string::npos);

  std::filesystem::create_directory(bench.path("out.vdb.slabs"));
  CHECK_THAT(bench.run(in + "out.vdb" + automatic).err, Contains("is there"));
  for (const std::string other : {"out.slabs", "out.vdb --keep power", "out.vdb --dry-run"})
    CHECK(bench.run(in + other + automatic).exitCode == 2);

  bench.mustRun(kTall + "in.vdb -q");  // fits
  bench.mustRun("segment in.vdb one.vdb --grid object -q");
  bench.mustRun("segment in.vdb all.vdb --grid object --auto-slabs -q");
  CHECK(bench.bytes("all.vdb") == bench.bytes("one.vdb"));
}

TEST_CASE("slabs: samples are made in slabs, and segmented slab by slab", "[slabs]") {
  const Bench bench;
  const std::string pack = "generate pack ", what = " --dims 50x40x300 --radius 4:9 -q";
  bench.mustRun(pack + "in.vdb" + what);
  bench.mustRun(pack + "in.slabs" + what);
  const Json whole = gridOf(infoOf(bench, "in.vdb"), "object"),
             slabs = gridOf(infoOf(bench, "in.slabs"), "object");
  for (const char* key : {"active_voxels", "active_min", "active_max"})
    CHECK(slabs.at(key) == whole.at(key));
  for (const std::string options : {"", "--crop 3,0,9:45,39,260", "--phase 1 --boundary closed"}) {
    INFO(options);
    bench.mustRun("segment in.vdb one.vdb -q " + options);
    bench.mustRun("segment in.slabs out.slabs --slab-height 80 -q " + options);
    requireSame(bench);
    bench.mustRun("segment in.slabs joined.vdb -q " + options);
    CHECK(bench.bytes("joined.vdb") == bench.bytes("one.vdb"));
  }
  bench.mustRun("segment out.slabs other.slabs --range 3:9 -q");
  bench.mustRun("segment one.vdb few.vdb --range 3:9 -q");
  bench.mustRun("convert other.slabs back.vdb -q");
  CHECK(bench.bytes("back.vdb") == bench.bytes("few.vdb"));

  bench.mustRun(pack + "in.slabs --dims 20x20x200 --radius 3:4 -q");  // replaces slabs alone
  bench.write("none.slabs", "a file");
  for (const std::string& refused :
       {pack + "none.slabs" + what, std::string("generate snow s.slabs --size 40"),
        pack + "s.slabs --surface 1:4", pack + "s.slabs --size 20 --radius 0.1:0.2",
        pack + "nowhere/s.slabs --size 20"}) {
    INFO(refused);
    const Outcome run = bench.run(refused);
    CHECK(run.exitCode != 0);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  }
  CHECK(bench.bytes("none.slabs") == "a file");
  for (const std::string& name : bench.names()) CHECK(name.find(".part") == std::string::npos);
}

TEST_CASE("slabs: a folder that no run made is left alone", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  std::filesystem::create_directory(bench.path("out.slabs.part"));
  bench.write("out.slabs.part/mine", "precious");
  for (const std::string resume : {"", " --resume"}) {
    const Outcome refused = bench.run("segment in.vdb out.slabs --grid object -q" + resume);
    CHECK(refused.exitCode == 1);
    CHECK_THAT(refused.err, Contains("out.slabs.part: holds mine"));
  }
  CHECK(bench.bytes("out.slabs.part/mine") == "precious");
  CHECK_FALSE(bench.names().count("out.slabs"));
}

TEST_CASE("slabs: what was killed goes on", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  bench.mustRun("segment in.vdb one.vdb --grid object -q");
  std::mt19937 random(7);
  int kills = 0;
  for (int round = 0; round < 2; ++round) {
    const std::string segment = "segment in.vdb out.slabs --grid object --slab-height 8 -q";
    RunOptions killing;
    killing.interruptOn = "out.slabs.part";
    killing.signal = round % 3 == 0 ? SIGTERM : SIGKILL;
    Outcome run;
    double longest = 0.01;
    for (int i = 0; i < 80; ++i, longest *= 1.1) {  // it ends on slow machines, too
      killing.delay = longest * double(random() % 100) / 100;
      // The slabs stay cut as they were, whatever memory there is later.
      run = bench.run(segment + (i > 0 ? " --resume --max-memory 2GiB" : ""), killing);
      if (run.exitCode == 0) break;
      ++kills;
      INFO(run.err);
      REQUIRE(run.exitCode > 1);
    }
    REQUIRE(run.exitCode == 0);
    requireSame(bench);
    REQUIRE_FALSE(bench.names().count("out.slabs.part"));
    REQUIRE_FALSE(bench.names().count("out.slabs.scratch"));
    std::filesystem::remove_all(bench.path("out.slabs"));
  }
  CHECK(kills > 3);
}

TEST_CASE("slabs: what is finished is not done again to resume it", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  const std::string segment = "segment in.vdb out.slabs --grid object ";
  bench.mustRun(segment + "--slab-height 8 --resume -q");
  const std::string slab = bench.path("out.slabs/slab-0000.vdb");
  const auto made = std::filesystem::last_write_time(slab);
  const auto isMadeAnew = [&] { return std::filesystem::last_write_time(slab) != made; };
  const Outcome again = bench.run(segment + "--resume");
  CHECK(again.exitCode == 0);
  CHECK_THAT(again.err, Contains("out.slabs: is finished"));
  bench.mustRun(segment + "--resume -q --json again.json");
  bench.mustRun("segment in.vdb other.slabs --grid object --slab-height 8 -q --json first.json");
  const Json first = Json::parse(bench.bytes("first.json")),
             second = Json::parse(bench.bytes("again.json"));
  for (const char* key : {"grains", "object_voxels", "critical_points", "slab_count", "input"})
    CHECK(second.at(key) == first.at(key));
  CHECK(second.at("output") == "out.slabs");
  for (const std::string other : {"--gamma 5", "--keep manifold", "--crop 0,0,0:9,9,9", "--invert",
                                  "--boundary closed", "--strictness 9", "--tidy 0"}) {
    const Outcome refused = bench.run(segment + "--resume " + other);
    CHECK(refused.exitCode == 1);
    CHECK_THAT(refused.err, Contains("is finished, and was made of another input or with other"));
  }
  // What was asked for before counts, too.
  bench.mustRun("segment in.vdb closed.slabs --grid object --boundary closed --fill-holes 3 -q");
  for (const std::string less : {"--boundary closed", "--fill-holes 3"})
    CHECK(bench.run("segment in.vdb closed.slabs --grid object --resume " + less).exitCode == 1);
  std::filesystem::last_write_time(bench.path("in.vdb"),
                                   std::filesystem::file_time_type::clock::now());
  CHECK_THAT(bench.run(segment + "--resume").err, Contains("made of another input"));
  CHECK_FALSE(isMadeAnew());
  bench.mustRun(segment + "-q");
  CHECK(isMadeAnew());
  std::filesystem::resize_file(slab, std::filesystem::file_size(slab) - 9);
  const Outcome damaged = bench.run(segment + "--resume");
  CHECK(damaged.exitCode == 1);
  CHECK_THAT(damaged.err, Contains("slab-0000.vdb") && Contains("remove out.slabs first"));
  std::filesystem::remove(slab);
  CHECK_THAT(bench.run(segment + "--resume").err, Contains("slab-0000.vdb"));
}

TEST_CASE("slabs: a folder or a mask that changed since is another input", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  bench.mustRun("generate pack roi.tif --dims 40x33x93 --radius 9:12 -q");
  bench.mustRun("segment in.vdb in.slabs --grid object --slab-height 8 -q");
  const std::string segment = "segment in.slabs/ out.slabs/ --roi roi.tif --slab-height 8 --resume";
  bench.mustRun(segment + " -q");
  const Json index = Json::parse(bench.bytes("out.slabs/index.json"));
  CHECK(index.at("input") == "in.slabs");  // the slash, as shells complete it, is no part of it
  CHECK(index.at("input_bytes") > 0);
  CHECK_THAT(bench.run(segment).err, Contains("out.slabs: is finished"));
  for (const std::string name : {"in.slabs/slab-0001.vdb", "roi.tif"}) {
    const auto before = std::filesystem::last_write_time(bench.path(name));
    std::filesystem::last_write_time(bench.path(name),
                                     std::filesystem::file_time_type::clock::now());
    const Outcome refused = bench.run(segment);
    CHECK(refused.exitCode == 1);
    CHECK_THAT(refused.err, Contains("made of another input"));
    std::filesystem::last_write_time(bench.path(name), before);
    CHECK(bench.run(segment).exitCode == 0);
  }
  // The region, which each slab has, is counted once.
  const Json grids = Json::parse(bench.mustRun("info out.slabs --json -")).at("grids");
  REQUIRE(grids[1].at("name") == "region");
  CHECK(grids[1].at("active_voxels") == grids[0].at("region_voxels"));
  // So are samples whose name a header alone tells.
  bench.mustRun("convert roi.tif named.mhd -q");
  std::string header = bench.bytes("named.mhd");
  header.replace(header.find("named.raw"), 9, "other.raw");
  bench.write("named.mhd", header);
  std::filesystem::rename(bench.path("named.raw"), bench.path("other.raw"));
  const std::string ofHeader = "segment named.mhd named.slabs --slab-height 8 --resume";
  bench.mustRun(ofHeader + " -q");
  std::filesystem::last_write_time(bench.path("other.raw"),
                                   std::filesystem::file_time_type::clock::now());
  CHECK_THAT(bench.run(ofHeader).err, Contains("made of another input"));
}

TEST_CASE("slabs: nothing is made of a half of what a run left", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  bench.mustRun("segment in.vdb one.vdb --grid object -q");
  const std::string segment =
      "segment in.vdb out.slabs --grid object -q --scratch kept --slab-height ";
  RunOptions killing;
  killing.signal = SIGKILL;
  killing.interruptOn = "kept/put-1.piece";
  for (int i = 0; i < 20; ++i) {
    for (const char* name : {"out.slabs", "out.slabs.part", "kept"})
      std::filesystem::remove_all(bench.path(name));
    const Outcome run = bench.run(segment + "8", killing);
    if (run.exitCode != 0 && !std::filesystem::exists(bench.path("kept/done.piece"))) break;
  }
  REQUIRE(std::filesystem::exists(bench.path("kept/put-1.piece")));
  constexpr auto kAll = std::filesystem::copy_options::recursive;
  const auto restore = [&] {
    for (const std::string name : {"out.slabs.part", "kept"}) {
      std::filesystem::remove_all(bench.path(name));
      std::filesystem::copy(bench.path(name + ".copy"), bench.path(name), kAll);
    }
  };
  for (const std::string name : {"out.slabs.part", "kept"})
    std::filesystem::copy(bench.path(name), bench.path(name + ".copy"), kAll);
  const auto refused = [&](const std::string& arguments, const std::string& why) {
    const Outcome run = bench.run(arguments);
    CHECK(run.exitCode != 0);
    CHECK_THAT(run.err, Contains(why));
    CHECK_FALSE(bench.names().count("out.slabs"));
    CHECK_FALSE(bench.names().count("other.slabs"));
    restore();
  };
  std::filesystem::remove_all(bench.path("out.slabs.part"));  // scratch without slabs
  refused(segment + "8 --resume", "slab-0000.vdb: is missing");
  std::filesystem::remove(bench.path("kept/part-3.piece"));
  refused(segment + "8 --resume", "cannot be opened");
  refused("segment in.vdb other.slabs --grid object -q --scratch kept --slab-height 8 --resume",
          "another input");
  std::filesystem::remove_all(bench.path("kept"));  // slabs without scratch
  bench.mustRun(segment + "32 --resume");
  requireSame(bench);
}

TEST_CASE("slabs: what cannot be is said in one line", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  const auto refused = [&](const std::string& arguments, const std::string& why,
                           int code = kFailed) { refuses(bench, code, arguments, {why}); };
  const std::string segment = "segment in.vdb out.slabs --grid object ";
  refused(segment + "--keep power", "--keep manifold alone", kWrongUsage);
  refused(segment + "--tables tables", "by vdb_madf measure", kWrongUsage);
  refused(segment + "--max-memory 100MiB", "allow more");
  refused("segment none.tif out.slabs", "none.tif");
  refused("segment in.vdb one.vdb --grid object --resume", "OUT.slabs", kWrongUsage);
  bench.write("out.slabs", "a file");
  refused(segment, "is there");
  CHECK(bench.bytes("out.slabs") == "a file");
  std::filesystem::remove(bench.path("out.slabs"));

  // Scratch of other work, and damaged.
  RunOptions killing;
  killing.interruptOn = "out.slabs.scratch/cuts.piece";
  killing.signal = SIGKILL;
  for (int i = 0; i < 20; ++i) {
    for (const char* name : {"out.slabs", "out.slabs.part", "out.slabs.scratch"})
      std::filesystem::remove_all(bench.path(name));
    if (bench.run(segment + "-q --slab-height 8", killing).exitCode != 0) break;
  }
  REQUIRE(std::filesystem::exists(bench.path("out.slabs.scratch/cuts.piece")));
  CHECK_THAT(bench.run(segment + "--slab-height 8").err, Contains("resume"));
  CHECK_THAT(bench.run(segment + "--slab-height 16 --resume").err, Contains("other options"));
  CHECK_THAT(bench.run(segment + "--slab-height 8 --scratch out.slabs.part").err,
             Contains("another folder"));
  CHECK_THAT(bench.run(segment + "--slab-height 8 --scratch .").err, Contains("another folder"));
  const std::string about = bench.bytes("out.slabs.scratch/about.vdb");
  bench.write("out.slabs.scratch/about.vdb", about.substr(0, about.size() / 2));
  CHECK_THAT(bench.run(segment + "--slab-height 8 --resume").err,
             Contains("about.vdb: the scratch data is damaged"));
  bench.write("out.slabs.scratch/about.vdb", about);
  bench.write("out.slabs.scratch/object-0.piece", "damaged");
  CHECK_THAT(bench.run(segment + "--slab-height 8 --resume").err, Contains("damaged"));
}
