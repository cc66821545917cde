// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What other verbs make of a folder of slabs: what they make of one file.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/refusals.h"
#include "support/slab_runs.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

TEST_CASE("slabs: manifolds and their graph are those of one file", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8um -q");
  for (const std::string options :
       {"", "--gamma 9 --tidy 0 --boundary closed", "--fill-holes 1000 --merge neck",
        "--roi cylinder:z:20,16:14"}) {
    INFO(options);
    const std::string choice = " --grid object --keep manifold -q " + options;
    bench.mustRun("segment in.vdb one.vdb" + choice);
    bench.mustRun("segment in.vdb out.slabs --slab-height 16" + choice);
    requireSame(bench);
    bench.mustRun("remerge one.vdb merged.vdb --merge both --theta -0.5 -q");
    bench.mustRun("remerge out.slabs joined.vdb --merge both --theta -0.5 -q");
    REQUIRE(bench.bytes("joined.vdb") == bench.bytes("merged.vdb"));
    bench.mustRun("remerge one.vdb merged.vdb --strictness 8 -q");
    bench.mustRun("remerge out.slabs joined.vdb --strictness 8 -q");
    REQUIRE(bench.bytes("joined.vdb") == bench.bytes("merged.vdb"));
  }
  bench.mustRun("segment in.vdb auto.vdb --auto-slabs --grid object --keep manifold -q");
  CHECK(gridsOf(infoOf(bench, "auto.vdb")) == std::set<std::string>{"grain", "manifold"});

  const Outcome one = bench.run("remerge out.slabs/slab-0002.vdb one.vdb");
  CHECK(one.exitCode == 1);
  CHECK_THAT(one.err, Contains("slab-0002.vdb: ") && Contains("give the whole folder"));
}

TEST_CASE("slabs: remerge makes others of them, as of one file", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8um -q");
  using Merges = std::vector<std::string>;
  for (const auto& [options, merges] :
       {std::pair<std::string, Merges>{
            "", {"--merge both --theta -0.5", "--strictness 9 --tidy 9 --threads 1"}},
        {"--gamma 9 --boundary closed", {"--merge angle --delta 0 --tidy 0"}},
        {"--roi cylinder:z:20,16:14", {"--merge neck --min-grain 999"}}}) {
    const std::string choice = " --grid object --keep manifold -q " + options;
    bench.mustRun("segment in.vdb one.vdb" + choice);
    bench.mustRun("segment in.vdb in.slabs --slab-height 16" + choice);
    for (const std::string& merge : merges) {
      INFO(options << " " << merge);
      bench.mustRun("remerge one.vdb merged.vdb -q " + merge);
      bench.mustRun("remerge in.slabs out.slabs/ -q " + merge);
      bench.mustRun("convert out.slabs back.vdb -q");
      REQUIRE(bench.bytes("back.vdb") == bench.bytes("merged.vdb"));
      bench.mustRun("segment in.vdb fresh.slabs --slab-height 16" + choice + " " + merge);
      REQUIRE(bench.bytes("out.slabs/index.json") == bench.bytes("fresh.slabs/index.json"));
      REQUIRE(bench.bytes("out.slabs/slab-0002.vdb") == bench.bytes("fresh.slabs/slab-0002.vdb"));
    }
  }
  bench.mustRun("remerge in.slabs out.tif -q");
  bench.mustRun("remerge one.vdb one.tif -q");
  CHECK(bench.bytes("out.tif") == bench.bytes("one.tif"));

  const auto refused = [&](const std::string& arguments, const std::string& why,
                           int code = kFailed) { refuses(bench, code, arguments, {why}); };
  refused("remerge one.vdb other.slabs", "no folder of slabs");
  refused("remerge in.slabs in.slabs", "in.slabs", kWrongUsage);
  refused("remerge in.slabs other.slabs --tidy 17", "at least as many voxels high");
  refused("remerge in.slabs/slab-0001.vdb other.vdb", "give the whole folder");
  bench.mustRun("segment in.vdb bare.slabs --slab-height 16 --grid object -q");
  refused("remerge bare.slabs other.slabs", "--keep manifold");
  std::filesystem::remove(bench.path("in.slabs/slab-0003.vdb"));
  refused("remerge in.slabs other.slabs", "slab-0003.vdb: is missing");
  // A slab of other manifolds.
  bench.mustRun("segment in.vdb in.slabs --slab-height 16 --grid object --keep manifold -q");
  std::string bytes = bench.bytes("in.slabs/slab-0003.vdb");
  const size_t graph = bytes.find("madf_manifold_graph", bytes.find("madf_manifold_graph") + 1);
  REQUIRE(graph != std::string::npos);
  ++bytes[graph + 19 + 4 + 12 + 12];  // the squared radius of the first node
  bench.write("in.slabs/slab-0003.vdb", bytes);
  refused("remerge in.slabs other.slabs --no-verify", "in another slab");
  refused("remerge in.slabs other.vdb --no-verify", "another one in another part");
  bytes[graph + 19 + 4] = 9;  // the version
  bench.write("in.slabs/slab-0003.vdb", bytes);
  refused("remerge in.slabs other.slabs --no-verify", "slab-0003.vdb: it is damaged");
}

TEST_CASE("slabs: sweep merges their manifolds, as of one file", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8um -q");
  for (const std::string gamma : {"0", "9"}) {
    bench.mustRun(
        "segment in.vdb in.slabs --slab-height 16 --grid object --keep manifold -q --gamma " +
        gamma);
    const std::string how =
        " -q --merge both,neck --theta -1:-0.4:0.3 --delta 0,2 --small 300 --tidy 1 --plot ";
    bench.mustRun("sweep in.vdb one.csv --grid object --gamma " + gamma + how + "one.svg");
    bench.mustRun("sweep in.slabs cut.csv" + how + "cut.svg");
    CHECK(bench.bytes("one.csv") == bench.bytes("cut.csv"));
    CHECK(bench.bytes("one.svg") == bench.bytes("cut.svg"));
    CHECK(bench.mustRun("sweep in.slabs - --scratch data" + how + "cut.svg") ==
          bench.bytes("one.csv"));
  }
  CHECK_FALSE(bench.names().count("data"));
  CHECK_FALSE(bench.names().count("cut.csv.scratch"));
  bench.mustRun(
      "sweep in.slabs grain.csv --grid grain --gamma 0 --strictness 9 -q");  // segments it
  bench.mustRun("sweep in.vdb object.csv --grid object --gamma 0 --strictness 9 -q");
  CHECK(bench.bytes("grain.csv") == bench.bytes("object.csv"));

  const auto refused = [&](const std::string& arguments, const std::string& why,
                           int code = kFailed) {
    refuses(bench, code, "sweep in.slabs out.csv " + arguments, {why});
  };
  for (const std::string gamma : {"20", "0"})
    refused("--gamma " + gamma, "those of gamma 9", kWrongUsage);
  refused("--boundary closed", "--boundary", kWrongUsage);
  refused("--phase 1", "leave --phase out", kWrongUsage);
  refused("--fill-holes 3", "leave --fill-holes out", kWrongUsage);
  refused("--crop 0,0,0:9,9,9", "leave --crop out", kWrongUsage);
  refused("--tidy 17", "at least as many voxels high");
  refused("--scratch .", "no folder of scratch data");
  const Outcome piped = bench.run("sweep in.slabs -");
  CHECK(piped.exitCode == 2);
  CHECK_THAT(piped.err, Contains("--scratch DIR"));

  // What a killed one left is no use to the next, and in nobody's way.
  const std::string sweep = "sweep in.slabs again.csv --strictness 1:16:0.5 -q";
  const std::string rows = bench.mustRun("sweep in.slabs - --scratch data --strictness 1:16:0.5");
  RunOptions killing;
  killing.interruptOn = "again.csv.scratch";
  killing.signal = SIGKILL;
  for (int i = 0; i < 50 && !bench.names().count("again.csv.scratch"); ++i)
    bench.run(sweep, killing);  // on a busy machine it may end before
  REQUIRE(bench.names().count("again.csv.scratch"));
  bench.mustRun(sweep);
  CHECK(bench.bytes("again.csv") == rows);
  CHECK_FALSE(bench.names().count("again.csv.scratch"));
}

TEST_CASE("slabs: pictures are those of one file", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8x8x12um -q");
  bench.mustRun("convert in.vdb scan.tif --grid object -q");
  for (const std::string options : {"", "--roi cylinder:z:20,16:14 --tidy 0"}) {
    const std::string choice = " --grid object --slab-height 16 -q " + options;
    bench.mustRun("segment in.vdb out.slabs --keep manifold" + choice);
    bench.mustRun("convert out.slabs one.vdb -q");
    for (const std::string shown :
         {"", "--only slices --slice z=0,z=17,y=30,x=33", "--only view --azimuth 200",
          "--select 3,7", "--interfaces --select 3,5,2,1 --no-axes", "--overlay scan.tif",
          "--grid manifold --elevation -40"}) {
      INFO(options << " " << shown);
      bench.mustRun("render one.vdb one.png --size 150 -q " + shown);
      bench.mustRun("render out.slabs cut.png --size 150 -q " + shown);
      CHECK(bench.bytes("one.png") == bench.bytes("cut.png"));
    }
  }
  const auto refused = [&](const std::string& arguments, const std::string& why,
                           int code = kFailed) {
    refuses(bench, code, "render out.slabs no.png " + arguments, {"out.slabs", why});
  };
  refused("--select 1,9999", "there is no grain 9999");
  refused("--slice z=93", "there is no slice z = 93");
  refused("--grid power", "power");
  std::filesystem::remove(bench.path("out.slabs/slab-0002.vdb"));
  refused("", "slab-0002.vdb: is missing");
}

TEST_CASE("slabs: a report has the slider of one file with kept manifolds", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb --voxel-size 8um -q");
  const std::string options = " --grid object --keep manifold -q";
  bench.mustRun("segment in.vdb one.vdb" + options);
  bench.mustRun("segment in.vdb out.slabs --slab-height 24" + options);
  if (bench.run("report one.vdb one.html --title T -q").err.find("esbuild") != std::string::npos) {
    WARN("SKIPPED: a report of slabs: built without esbuild, libjs-three, libjs-jquery-datatables");
    return;
  }
  CHECK_THAT(bench.mustRun("report out.slabs cut.html --title T"), Contains("a slider"));
  const std::string whole = bench.bytes("one.html");
  std::string cut = bench.bytes("cut.html");
  for (size_t at = 0; (at = cut.find("out.slabs", at)) != std::string::npos;)
    cut.replace(at, 9, "one.vdb");
  CHECK(whole.find("id=\"joins\"") != std::string::npos);
  CHECK(cut == whole);
}

TEST_CASE("slabs: every verb that takes labels reads the folder", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q");
  bench.mustRun("segment in.vdb one.vdb --grid object -q");
  bench.mustRun("segment in.vdb out.slabs --grid object --slab-height 16 -q");
  const Json index = Json::parse(bench.bytes("out.slabs/index.json"));
  CHECK(index.at("format") == "vdb_madf slabs");
  CHECK(index.at("slabs").size() == 6);
  CHECK(index.at("slabs")[1] == Json({{"file", "slab-0001.vdb"}, {"z_first", 16}, {"z_last", 31}}));
  CHECK(index.at("grains") > 10);
  CHECK_THAT(bench.mustRun("compare out.slabs one.vdb"), Contains("0.0000 % (mirror 0.0000 %)"));
  CHECK(gridOf(infoOf(bench, "out.slabs"), "grain").at("active_voxels") ==
        gridOf(infoOf(bench, "one.vdb"), "grain").at("active_voxels"));
  CHECK(gridOf(infoOf(bench, "out.slabs/slab-0002.vdb"), "grain").at("active_min")[2] >= 32);
  bench.mustRun("measure one.vdb one -q");
  bench.mustRun("measure out.slabs cut -q");
  CHECK(bench.bytes("one/grains.csv") == bench.bytes("cut/grains.csv"));
  bench.mustRun("render out.slabs out.png -q");
  const Outcome report = bench.run("report out.slabs out.html -q");  // some builds have none
  CHECK((report.exitCode == 0 || report.err.find("esbuild") != std::string::npos));

  SECTION("but not a folder that lacks one") {
    std::filesystem::remove(bench.path("out.slabs/slab-0003.vdb"));
    const Outcome run = bench.run("compare out.slabs one.vdb");
    CHECK(run.exitCode == 1);
    CHECK_THAT(run.err, Contains("slab-0003.vdb: is missing"));
  }
  SECTION("nor one with a slab of another") {
    const auto replace = [&](const std::string& from) {
      std::filesystem::copy(bench.path(from), bench.path("out.slabs/slab-0005.vdb"),
                            std::filesystem::copy_options::overwrite_existing);
    };
    const auto requireRefused = [&](const std::string& why, const std::vector<std::string>& verbs) {
      for (const std::string& verb : verbs) {
        INFO(verb);
        const Outcome run = bench.run(verb);
        CHECK(run.exitCode == 1);
        CHECK_THAT(run.err, Contains("slab-0005.vdb: " + why));
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
      }
      for (const char* name : {"tables", "back.vdb", "out.raw"})
        CHECK_FALSE(bench.names().count(name));
    };
    bench.mustRun("segment in.vdb other.slabs --grid object --slab-height 8 -q");
    replace("other.slabs/slab-0005.vdb");
    requireRefused("is not slab 6 of 6",
                   {"compare one.vdb out.slabs", "measure out.slabs tables", "info out.slabs",
                    "convert out.slabs back.vdb", "convert out.slabs out.raw"});
    bench.mustRun("segment in.vdb other.slabs --grid object --slab-height 16 --strictness 12 -q");
    replace("other.slabs/slab-0005.vdb");
    requireRefused("does not fit slab-0000.vdb", {"measure out.slabs tables"});
  }
  SECTION("nor one whose index is damaged") {
    const std::string text = bench.bytes("out.slabs/index.json");
    const auto requireRefused = [&] {
      for (const std::string verb : {"measure out.slabs tables", "info out.slabs"}) {
        const Outcome run = bench.run(verb);
        CHECK(run.exitCode == 1);
        CHECK_THAT(run.err, Contains("index.json"));
        CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
      }
    };
    for (const size_t length : {size_t(0), size_t(20), size_t(120), text.size() - 3}) {
      bench.write("out.slabs/index.json", text.substr(0, length));
      requireRefused();
    }
    const auto changed = [&](const std::string& from, const std::string& to) {
      std::string other = text;
      REQUIRE(other.find(from) != std::string::npos);
      bench.write("out.slabs/index.json", other.replace(other.find(from), from.size(), to));
      requireRefused();
    };
    changed("\"z_last\": 31", "\"z_last\": 30");
    changed("\"z_last\": 31", "\"z_last\": 1e99");
    changed("\"z_first\": 16", "\"z_first\": \"16\"");
    changed("slab-0002.vdb", "../../etc/passwd");
    changed("\"slabs\": [", "\"slabs\": [[]],\"others\": [");
    std::filesystem::remove(bench.path("out.slabs/index.json"));
    requireRefused();
  }
}

TEST_CASE("slabs: tables, comparisons and images are those of one file", "[slabs]") {
  const Bench bench;
  struct Sample {
    std::string made, height, options, measures;
  };
  for (const Sample& sample :
       {Sample{"--voxel-size 8um", "8", "",
               "--shape --edge-weights --crossing --voronoi --bootstrap 100 --min-faces 5"},
        Sample{"--voxel-size 8x8x20um", "16", "--boundary closed --tidy 0", "--shape"},
        Sample{"", "40", "--fill-holes 1000 --merge neck", "--boundary closed --sample a"}}) {
    INFO(sample.made);
    bench.mustRun(kTall + "in.vdb -q " + sample.made);
    const std::string choice = " --grid object -q " + sample.options;
    bench.mustRun("segment in.vdb one.vdb" + choice);
    bench.mustRun("segment in.vdb out.slabs --slab-height " + sample.height + choice);
    bench.mustRun("segment in.vdb kept.vdb --grid object --keep distance -q");
    bench.mustRun("convert kept.vdb scan.npy --grid distance_squared -q");
    bench.mustRun("measure one.vdb one --intensity scan.npy -q " + sample.measures);
    bench.mustRun("measure out.slabs cut --intensity scan.npy -q " + sample.measures);
    for (const std::string name : {"grains.csv", "bonds.csv"})
      REQUIRE(bench.bytes("one/" + name) == bench.bytes("cut/" + name));
    Json one = Json::parse(bench.bytes("one/sample.json")),
         cut = Json::parse(bench.bytes("cut/sample.json"));
    CHECK(one.at("labels_digest").get<std::string>().size() == 32);
    one.erase("labels");
    cut.erase("labels");
    CHECK(one == cut);

    bench.mustRun("segment in.vdb other.slabs --slab-height 24 --gamma 5" + choice);
    bench.mustRun("convert other.slabs other.vdb -q");
    const std::string truth = bench.mustRun("compare one.vdb other.vdb");
    for (const std::string pair : {"one.vdb other.slabs", "out.slabs other.slabs"})
      CHECK(bench.mustRun("compare " + pair) == truth);
    for (const std::string image :
         {"raw", "tif", "raw --out-type uint8 --domain 0,-2,-5:45,40,110"}) {
      const std::string name = "." + image.substr(0, 3);
      bench.mustRun("convert one.vdb a." + image + " -q");
      bench.mustRun("convert out.slabs b." + image + " -q");
      CHECK(bench.bytes("a" + name) == bench.bytes("b" + name));
    }
    const Json whole = gridOf(infoOf(bench, "one.vdb"), "grain"),
               slabs = gridOf(infoOf(bench, "out.slabs"), "grain");
    for (const char* key : {"active_voxels", "active_min", "active_max", "voxel_size_units"})
      CHECK(slabs.at(key) == whole.at(key));
  }
}

TEST_CASE("slabs: exports are those of one file", "[slabs]") {
  const Bench bench;
  bench.mustRun(kTall + "in.vdb -q --voxel-size 8x8x20um");
  const auto filesOf = [&](const std::string& name) {
    std::map<std::string, std::string> files;
    const std::filesystem::path path = bench.path(name);
    if (std::filesystem::is_regular_file(path))
      return std::map<std::string, std::string>{{"", bench.bytes(name)}};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
      const std::string file = std::filesystem::relative(entry.path(), path).string();
      if (entry.is_regular_file()) files[file] = bench.bytes(name + "/" + file);
    }
    return files;
  };
  for (const std::string options :
       {"", "--boundary closed --crop 3,3,5:35,30,71", "--roi cylinder:z:20,16:14"}) {
    INFO(options);
    bench.mustRun("segment in.vdb one.vdb --grid object -q " + options);
    bench.mustRun("segment in.vdb in.slabs --slab-height 16 --grid object -q " + options);
    for (const std::string kind :
         {"ome.zarr", "zarr --ome 0.5 --min-faces 5", "graphml --min-faces 5", "csv --as network",
          "vtp --as network", "mha --as mask", "tif --as mask", "zarr --meshes", "ply",
          "ply --reduce 2", "glb --max-dim 20", "vdb --as lod", "vdb --as lod --reduce 3",
          "vdb --as viz", "vdb --as viz --max-dim 9"}) {
      INFO(kind);
      const std::string ending = kind.substr(0, kind.find(' ')),
                        as = kind.substr(std::min(kind.size(), ending.size()));
      std::filesystem::remove_all(bench.path("kept"));
      std::filesystem::remove_all(bench.path("out." + ending));
      bench.mustRun("export one.vdb out." + ending + as + " -q");
      std::filesystem::rename(bench.path("out." + ending), bench.path("kept"));
      bench.mustRun("export in.slabs out." + ending + as + " -q");
      const auto files = filesOf("out." + ending), wanted = filesOf("kept");
      CHECK(!files.empty());
      CHECK((files == wanted));
    }
    // What needs all labels says so before it reads them.
    CHECK_THAT(bench.run("export in.slabs out.ply").err, Contains("in memory together: about"));
    CHECK(bench.run("export one.vdb out.ply").err.empty());
    bench.mustRun("measure one.vdb one -q");
    bench.mustRun("measure in.slabs cut -q");
    CHECK(bench.bytes("one/grains.csv") == bench.bytes("cut/grains.csv"));
  }
  std::filesystem::remove(bench.path("in.slabs/slab-0001.vdb"));
  for (const std::string name : {"none.zarr", "none.graphml", "none.npy --as mask"}) {
    const Outcome run = bench.run("export in.slabs " + name);
    CHECK(run.exitCode == 1);
    CHECK_THAT(run.err, Contains("slab-0001.vdb: is missing"));
    CHECK_FALSE(bench.names().count(name.substr(0, name.find(' '))));
  }
}
