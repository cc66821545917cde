// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf segment, run as a user runs it.

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

TEST_CASE("cli: segment reports what it did as JSON", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  const std::string printed = bench.mustRun("segment s.vdb g.vdb --gamma 4 --json j.json");
  CHECK(printed.find("grains") != std::string::npos);
  const Json json = Json::parse(bench.bytes("j.json"));
  for (const char* key : {"object_voxels",
                          "medial_balls",
                          "kept_balls",
                          "critical_points",
                          "grains",
                          "largest_squared_distance",
                          "leaves",
                          "porosity",
                          "seconds_read",
                          "seconds_write",
                          "seconds_total",
                          "peak_memory_bytes",
                          "threads",
                          "voxel_size_mm",
                          "page_faults_labels",
                          "page_faults_total",
                          "gamma",
                          "strictness",
                          "boundary",
                          "merge",
                          "input",
                          "output",
                          "fill_holes",
                          "tidy",
                          "cavities",
                          "cavity_voxels",
                          "crumbs",
                          "specks",
                          "slivers",
                          "grains_in_pieces",
                          "hints"})
    CHECK(json.count(key) == 1);
  CHECK(json.at("gamma") == 4);
  CHECK(json.at("merge") == "score");
  CHECK(json.at("strictness") == 11);
  CHECK(json.at("boundary") == "open");
  CHECK(json.at("fill_holes") == 27);
  CHECK(json.at("tidy") == 2);
  CHECK(json.at("grains_in_pieces") == 0);
  CHECK(json.at("grains").get<int>() > 1);
  CHECK(json.at("porosity").get<double>() ==
        Approx(1 - json.at("object_voxels").get<double>() / (48 * 48 * 48)));

  double sum = 0;
  int stages = 0;
  for (const auto& [key, value] : json.items()) {
    if (key.rfind("seconds_", 0) != 0 || key == "seconds_total") continue;
    CHECK(value.get<double>() >= 0);
    sum += value.get<double>();
    ++stages;
  }
  CHECK(stages >= 8);
  CHECK(sum == Approx(json.at("seconds_total").get<double>()));

  const Json alone = Json::parse(bench.mustRun("segment s.vdb g.vdb --json -"));
  CHECK(alone.at("grains").get<int>() > 1);
  CHECK(Json::parse(bench.mustRun("segment s.vdb g.vdb --json /dev/stdout")).count("grains") == 1);
  CHECK(bench.mustRun("segment s.vdb g.vdb --json /dev/null -q") == "");
  CHECK(bench.mustRun("segment s.vdb g.vdb -q") == "");
}

TEST_CASE("cli: segment keeps the grids that are asked for, each with its metadata", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb");
  CHECK(gridsOf(infoOf(bench, "g.vdb")) == std::set<std::string>{"grain"});
  bench.mustRun(
      "segment s.vdb g.vdb --keep distance,power,manifold,balls --merge both --theta -0.7");
  const Json info = infoOf(bench, "g.vdb");
  CHECK(gridsOf(info) == std::set<std::string>{"grain", "distance_squared", "power", "manifold",
                                               "balls", "balls_cell_size"});
  for (const Json& grid : info.at("grids")) {
    CAPTURE(grid.at("name"));
    CHECK(grid.at("value_type") == "int32");
    const Json& metadata = grid.at("metadata");
    for (const char* key :
         {"madf_version", "madf_gamma", "madf_boundary", "madf_merge", "madf_adjacency",
          "madf_domain_min", "madf_domain_max", "madf_voxel_size_m", "madf_length_unit",
          "madf_source", "madf_grains", "madf_object_voxels", "madf_critical_points"})
      CHECK(metadata.count(key) == 1);
    CHECK(metadata.at("madf_theta") == -0.7);
  }
  CHECK(gridOf(info, "manifold").at("metadata").count("madf_manifold_graph") == 1);
  CHECK(gridOf(info, "balls").at("active_voxels") ==
        gridOf(info, "balls").at("metadata").at("madf_medial_balls"));
}

TEST_CASE("cli: segment writes the same bytes for any number of threads", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  for (const std::string options : {"", " --gamma 3 --keep distance,power,manifold,balls"}) {
    bench.mustRun("segment s.vdb one.vdb --threads 1" + options);
    bench.mustRun("segment s.vdb two.vdb --threads 2" + options);
    CHECK(bench.bytes("one.vdb") == bench.bytes("two.vdb"));
  }
}

TEST_CASE("cli: the paper's merging is a short form", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb short.vdb --paper");
  const std::string plain = " --delta 0 --fill-holes 0 --tidy 0";
  bench.mustRun("segment s.vdb long.vdb --merge angle --adjacency cell --theta -0.8" + plain);
  CHECK(bench.bytes("short.vdb") == bench.bytes("long.vdb"));
  bench.mustRun("segment s.vdb short.vdb --paper --theta -0.6");
  bench.mustRun("segment s.vdb long.vdb --merge angle --adjacency cell --theta -0.6" + plain);
  CHECK(bench.bytes("short.vdb") == bench.bytes("long.vdb"));
}

TEST_CASE("cli: segment and remerge write images as convert does", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  bench.mustRun("remerge g.vdb r.vdb --merge both --theta -0.5");
  for (const std::string ending : {".tif", ".raw", ".mha", ".nrrd", ".npy"}) {
    CAPTURE(ending);
    const std::string said = bench.mustRun("segment s.vdb segmented" + ending);
    CHECK(said.find("segmented" + ending + ": grid 'grain', 48x48x48 voxels of type ") == 0);
    bench.mustRun("convert g.vdb wanted" + ending);
    CHECK(bench.bytes("segmented" + ending) == bench.bytes("wanted" + ending));
    bench.mustRun("remerge g.vdb remerged" + ending + " --merge both --theta -0.5");
    bench.mustRun("convert r.vdb wanted" + ending);
    CHECK(bench.bytes("remerged" + ending) == bench.bytes("wanted" + ending));
  }
  CHECK(Json::parse(bench.mustRun("segment s.vdb x.tif --json -")).at("output") == "x.tif");
}

TEST_CASE("cli: an empty object has no grains", "[cli]") {
  const Bench bench;
  bench.write("zero.raw", std::string(64, '\0'));
  for (const std::string boundary : {"open", "closed"}) {
    const Json json = Json::parse(bench.mustRun(
        "segment zero.raw g.vdb --dims 4x4x4 --type uint8 --json - --boundary " + boundary));
    CHECK(json.at("grains") == 0);
    CHECK(json.at("porosity") == 1);
    bench.mustRun("render g.vdb g.png");
    bench.mustRun("compare g.vdb g.vdb");
    bench.mustRun("convert g.vdb g.raw -q");
    CHECK(bench.bytes("g.raw") == std::string(4 * 64, '\0'));
  }
  bench.mustRun(kSnow + "s.raw");
  for (const char* verb : {"segment", "convert"}) {
    const std::string command = std::string(verb) + " s.raw out.vdb --dims 48x48x48 --type uint8 ";
    const Outcome nothing = bench.run(command + "--phase 9");
    CHECK(nothing.exitCode == 0);
    CHECK(nothing.out.find("nothing is selected") != std::string::npos);
    CHECK(nothing.out.find("grain diameter") == std::string::npos);
    CHECK(nothing.err.find("vdb_madf: note: s.raw: nothing is selected") == 0);
    CHECK(bench.mustRun(command).find("nothing is selected") == std::string::npos);
  }
}

TEST_CASE("cli: segment --dry-run says what it would take, and does nothing", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack p.vdb --size 160 --radius 8:16");
  const auto before = bench.names();
  const Json estimate = Json::parse(bench.mustRun("segment p.vdb --dry-run --json -"));
  CHECK(bench.names() == before);
  CHECK(estimate.at("fits") == true);
  const Json done = Json::parse(bench.mustRun("segment p.vdb g.vdb --json -"));
  CHECK(estimate.at("object_voxels") == done.at("object_voxels"));
  CHECK(estimate.at("leaves") == done.at("leaves"));
  const double needed = estimate.at("estimated_memory_bytes"), peak = done.at("peak_memory_bytes");
  CHECK(needed > 0.5 * peak);
  CHECK(needed < 3 * peak);
  CHECK(bench.mustRun("segment p.vdb --dry-run --max-memory 1M").find("it does not fit") !=
        std::string::npos);

  RunOptions little;  // ulimit -v
  little.memory = int64_t(2) << 30;
  const Json within = Json::parse(bench.run("segment p.vdb --dry-run --json -", little).out);
  CHECK(within.at("memory_limit_bytes") < little.memory);

  const std::string inSlabs = "segment p.vdb o.slabs --slab-height 40 ";
  const Json slabs = Json::parse(bench.mustRun(inSlabs + "--dry-run --json -"));
  CHECK_THAT(bench.mustRun(inSlabs + "--dry-run"), Contains("slabs            4") &&
                                                       Contains("scratch          up to some ") &&
                                                       Contains("it fits"));
  CHECK(bench.run(inSlabs + "--dry-run --resume").exitCode == 2);
  const Json made = Json::parse(bench.mustRun(inSlabs + "--json -"));
  for (const char* same : {"object_voxels", "leaves", "slab_count"})
    CHECK(slabs.at(same) == made.at(same));
  const int64_t kibibytes = slabs.at("estimated_memory_bytes").get<int64_t>() / 1024;
  bench.mustRun(inSlabs + "-q --max-memory " + std::to_string(kibibytes) + "KiB");
  CHECK(slabs.at("slab_count") == 4);
  CHECK(slabs.at("estimated_scratch_bytes") == 5 * slabs.at("object_voxels").get<int64_t>());
  const Json filtered = Json::parse(bench.mustRun(inSlabs + "--gamma 9 --dry-run --json -"));
  CHECK(filtered.at("estimated_scratch_bytes") > slabs.at("estimated_scratch_bytes"));
  const double slabMemory = slabs.at("estimated_memory_bytes");
  CHECK(slabMemory > made.at("peak_memory_bytes"));
  // The peak here is without what loading the libraries takes (warm_start.c): up to 29 MB, as a
  // start of the program alone shows, by release.
  constexpr double kLibraries = 28 << 20;
  CHECK(slabMemory < 4 * (made.at("peak_memory_bytes").get<double>() + kLibraries));
}
