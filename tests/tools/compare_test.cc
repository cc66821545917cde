// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf compare, run as a user runs it.

#include <algorithm>
#include <string>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;

TEST_CASE("cli: compare finds a file equal to itself", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun(kSpheres + "s.tif");
  for (const std::string pair : {"s.vdb s.vdb", "s.vdb s.truth.tif", "s.truth.tif s.vdb"}) {
    CAPTURE(pair);
    const Json json = Json::parse(bench.mustRun("compare " + pair + " --json -"));
    CHECK(json.at("truth_grains") == 5);
    CHECK(json.at("test_grains") == 5);
    CHECK(json.at("misclassified_percent") == 0);
    CHECK(json.at("adjusted_rand_index") == 1);
    CHECK(json.at("variation_of_information_bits").get<double>() == Approx(0).margin(1e-12));
  }
  bench.mustRun("segment s.vdb one.vdb --theta 1 --merge angle --adjacency cell");
  const Json json = Json::parse(bench.mustRun("compare s.vdb one.vdb --json -"));
  CHECK(json.at("test_grains").get<int>() < 5);
  CHECK(json.at("adjusted_rand_index").get<double>() < 1);
  CHECK(bench.mustRun("compare s.vdb one.vdb").find("misclassified") != std::string::npos);
  CHECK(bench.mustRun("compare s.vdb one.vdb -q") == "");

  CHECK(json.at("same_topology") == true);
  CHECK(json.at("splits").empty());
  REQUIRE(json.at("merges").size() == 1);
  CHECK(json.at("merges")[0].at("truth").size() >= 2);
  bench.mustRun("compare s.vdb one.vdb --grains grains.csv --confusion confusion.csv");
  const auto lines = [&](const std::string& file) {
    const std::string text = bench.bytes(file);
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(lines("grains.csv") == 1 + 5 + json.at("test_grains").get<int>());
  CHECK(lines("confusion.csv") >= 1 + 5);
}

TEST_CASE("cli: compare says when the grids differ in topology", "[cli]") {
  const Bench bench;
  bench.write("a.raw", std::string("\1\1\2\2", 4));
  bench.write("b.raw", std::string("\0\1\2\2", 4));
  const std::string pair = "compare a.raw b.raw --dims 4x1x1 --type uint8";
  CHECK_THAT(bench.run(pair).err,
             vdb_madf::test::Contains("note: the grids differ in topology: 75.0 % of the labeled"));
  const Json json = Json::parse(bench.run(pair + " --json -").out);
  CHECK(json.at("same_topology") == false);
  CHECK(json.at("notes").size() == 1);
  CHECK(bench.mustRun(pair + " -q --grains -") ==
        "side,grain,voxels,partner,overlap_voxels,intersection_over_union,pieces\n"
        "truth,1,2,1,1,0.5,1\ntruth,2,2,2,2,1,1\ntest,1,1,1,1,0.5,1\ntest,2,2,2,2,1,1\n");
  CHECK(bench.mustRun(pair + " -q --confusion -") == "truth,test,voxels\n1,0,1\n1,1,1\n2,2,2\n");

  CHECK(bench.run(pair).err.find("domains differ") == std::string::npos);
  bench.mustRun("convert a.raw a.npy --dims 4x1x1 --type uint8");
  bench.mustRun("convert a.raw longer.npy --dims 2x2x1 --type uint8");
  CHECK_THAT(bench.run("compare a.npy longer.npy").err, vdb_madf::test::Contains("domains differ"));
}

TEST_CASE("cli: the dataset is that of each input that has some", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --grid object");
  bench.mustRun("edit g.vdb h.vdb --drop 2");
  for (const std::string name : {"g", "h"})
    bench.mustRun("export " + name + ".vdb " + name + ".zarr");
  const auto grains = [&](const std::string& pair) {
    const Json json = Json::parse(bench.mustRun("compare " + pair + " --json - -q"));
    return std::make_pair(json.at("truth_grains").get<int>(), json.at("test_grains").get<int>());
  };
  const auto expected = grains("g.vdb h.vdb --truth-grid grain");
  REQUIRE(expected.first == expected.second + 1);
  CHECK(grains("g.zarr h.zarr --dataset labels/grain") == expected);
  CHECK(grains("g.zarr h.vdb --dataset labels/grain") == expected);
  CHECK(grains("g.vdb h.zarr --truth-grid grain --dataset labels/grain") == expected);
  refuses(bench, kFailed, "compare g.vdb h.vdb --truth-grid grain --dataset labels/grain",
          {"--dataset is for Zarr and HDF5"});
  refuses(bench, kFailed, "track g.zarr h.zarr --dataset labels/none",
          {"zarr: there is no Zarr array 'labels/none'"});
}
