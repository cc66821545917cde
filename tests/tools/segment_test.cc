// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verbs segment, remerge, sweep and compare, run as a user runs them.

#include <algorithm>
#include <sstream>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/svg.h"

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

TEST_CASE("cli: remerge equals a fresh segmentation", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  for (const std::string options :
       {"", " --strictness 9", " --strictness 12.5 --tidy 0", " --merge both --theta 1",
        " --merge angle --adjacency cell", " --merge neck", " --merge both --delta 9 --tidy 5",
        " --min-grain 400", " --merge angle --min-grain 400 --tidy 0"}) {
    CAPTURE(options);
    bench.mustRun("remerge g.vdb re.vdb" + options);
    bench.mustRun("segment s.vdb fresh.vdb --keep manifold" + options);
    CHECK(bench.bytes("re.vdb") == bench.bytes("fresh.vdb"));
    bench.mustRun("remerge re.vdb back.vdb");  // the manifolds went along
    CHECK(bench.bytes("back.vdb") == bench.bytes("g.vdb"));
  }
}

TEST_CASE("cli: a least grain is told, swept and taken along", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  const Json plain = Json::parse(bench.mustRun("segment s.vdb g.vdb --keep manifold --json -"));
  CHECK(plain.count("min_grain") == 0);
  CHECK(bench.mustRun("segment s.vdb h.vdb --keep manifold --min-grain 0 --tidy 0")
            .find("min-grain") == std::string::npos);
  const std::string said = bench.mustRun("segment s.vdb m.vdb --min-grain 400 --tidy 0");
  CHECK(said.find("fill-holes 27, min-grain 400, tidy 0\n") != std::string::npos);
  CHECK(bench.mustRun("segment s.vdb n.vdb --merge both --min-grain 400")
            .find("fill-holes 27, delta 2, min-grain 400, tidy 2\n") != std::string::npos);
  const Json json = Json::parse(bench.mustRun("segment s.vdb m.vdb --min-grain 400 --json -"));
  CHECK(json.at("min_grain") == 400);
  CHECK(json.at("grains") < plain.at("grains"));
  CHECK(gridOf(infoOf(bench, "m.vdb"), "grain").at("metadata").at("madf_min_grain") == 400);
  CHECK(gridOf(infoOf(bench, "g.vdb"), "grain").at("metadata").count("madf_min_grain") == 0);
  bench.mustRun("sweep s.vdb a.csv --strictness 11 --min-grain 400");
  CHECK(bench.bytes("a.csv").find("\n0,score,11,,," + std::to_string(json.at("grains").get<int>()) +
                                  ",") != std::string::npos);
  // Before they are tidied, labels are those of the edit.
  bench.mustRun("segment s.vdb m.vdb --min-grain 400 --tidy 0");
  bench.mustRun("edit h.vdb e.vdb --join-below 400");
  const Json same = Json::parse(bench.mustRun("compare m.vdb e.vdb --json -"));
  CHECK(same.at("misclassified_percent") == 0);
  CHECK(same.at("test_grains") == json.at("grains"));
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

TEST_CASE("cli: sweep gives a line for each choice, equal to its segmentation", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun(
      "sweep s.vdb a.csv --gamma 0,9 --theta -1:-0.7:0.1,-0.95 --merge angle,both --small 50 "
      "--delta 2,4 --tidy 1 --fill-holes 9 --plot a.svg");
  std::istringstream csv(bench.bytes("a.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  REQUIRE(lines.size() == 1 + 2 * 2 * 2 * 5);
  CHECK(lines[0].find("gamma,merge,strictness,delta,theta,grains,median_voxels,") == 0);
  for (const auto& [line, options] :
       {std::pair<size_t, std::string>{1, "--gamma 0 --theta -1 --merge angle"},
        {8, "--gamma 0 --theta -0.8 --merge angle --delta 4"},
        {25, "--gamma 9 --theta -0.95 --merge angle"},
        {39, "--gamma 9 --theta -0.7 --merge both --delta 4"}}) {
    const Json json = Json::parse(
        bench.mustRun("segment s.vdb g.vdb --tidy 1 --fill-holes 9 --json - " + options));
    std::istringstream fields(lines[line]);
    std::string gamma, merge, strictness, delta, theta, grains;
    for (std::string* field : {&gamma, &merge, &strictness, &delta, &theta, &grains})
      std::getline(fields, *field, ',');
    CHECK(std::stoi(delta) == json.at("delta"));
    const std::string flaws = "," + std::to_string(json.at("crumbs").get<int>()) + "," +
                              std::to_string(json.at("specks").get<int>()) + "," +
                              std::to_string(json.at("slivers").get<int>()) + "," +
                              std::to_string(json.at("grains_in_pieces").get<int>());
    CHECK(lines[line].substr(lines[line].size() - flaws.size()) == flaws);
    CHECK(std::stoll(gamma) == json.at("gamma"));
    CHECK(merge == json.at("merge").get<std::string>());
    CHECK(std::stod(theta) == json.at("theta"));
    CHECK(std::stoll(grains) == json.at("grains"));
  }
  const std::string svg = bench.bytes("a.svg");
  CHECK(svg.find("<svg ") != std::string::npos);
  CHECK(svg.substr(svg.size() - 7) == "</svg>\n");
  CHECK(svg.find("nan") == std::string::npos);
  // In three diagrams and the legend.
  CHECK(countInSvg(svg, "stroke:rgb(0%,44.705882%") == 4 * 4);
  CHECK(countInSvg(svg, "stroke:rgb(83.529412%,36") == 4 * 4);

  bench.mustRun(
      "sweep s.vdb b.csv --gamma 0,9 --theta -1:-0.7:0.1,-0.95 --merge angle,both --small 50 "
      "--delta 2,4 --tidy 1 --fill-holes 9 --plot b.svg --threads 1");
  CHECK(bench.bytes("a.csv") == bench.bytes("b.csv"));
  CHECK(svg == bench.bytes("b.svg"));
}

TEST_CASE("cli: grains by score, segmented, remerged and swept", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb all.vdb --keep manifold");
  bench.mustRun("sweep s.vdb a.csv --strictness 9:12:1.5,11 --plot a.svg");
  std::istringstream csv(bench.bytes("a.csv"));
  std::string line;
  std::getline(csv, line);
  CHECK(line.find("gamma,merge,strictness,delta,theta,grains,") == 0);
  for (const std::string strictness : {"9", "10.5", "12", "11"}) {
    std::getline(csv, line);
    CAPTURE(strictness, line);
    const std::string how = strictness == "11" ? "" : " --strictness " + strictness;
    const Json json = Json::parse(bench.mustRun("segment s.vdb g.vdb --json -" + how));
    CHECK(line.find("0,score," + strictness + ",,," + std::to_string(json.at("grains").get<int>()) +
                    ",") == 0);
    bench.mustRun("remerge all.vdb r.vdb" + how);
    bench.mustRun("convert r.vdb r.npy --grid grain");
    bench.mustRun("convert g.vdb g.npy --grid grain");
    CHECK(bench.bytes("r.npy") == bench.bytes("g.npy"));
  }
  CHECK(bench.bytes("a.svg").find("nan") == std::string::npos);
  const Json json = Json::parse(bench.mustRun("segment s.vdb g.vdb --json -"));
  CHECK(json.at("strictness") == 11);
  for (const char* key : {"theta", "delta", "adjacency"}) CHECK(!json.contains(key));
  const std::string said = bench.mustRun("segment s.vdb g.vdb");
  CHECK(said.find("merge score, strictness 11, boundary open,\n") != std::string::npos);
  CHECK(said.find("theta") == std::string::npos);
  bench.mustRun("sweep s.vdb b.csv --merge neck,score --theta -0.9 --strictness 11");
  CHECK(bench.bytes("b.csv").find("\n0,neck,,2,-0.9,") != std::string::npos);
  CHECK(bench.bytes("b.csv").find("\n0,score,11,,,") != std::string::npos);
}

TEST_CASE("cli: the joins of the hierarchy, in one file and in slabs", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb all.vdb --keep manifold --strictness 3");
  CHECK(bench.mustRun("hierarchy all.vdb joins.csv").find(" joins of ") != std::string::npos);
  const std::string table = bench.bytes("joins.csv");
  std::istringstream csv(table);
  std::string line, last;
  std::getline(csv, line);
  CHECK(line ==
        "join,score,strictness,grains,first,first_x,first_y,first_z,first_voxels,second,second_x,"
        "second_y,second_z,second_voxels");
  while (std::getline(csv, line)) {
    std::istringstream fields(line);
    std::string join, score, strictness, grains;
    for (std::string* field : {&join, &score, &strictness, &grains})
      std::getline(fields, *field, ',');
    if (std::stod(strictness) < 3) break;
    last = grains;
  }
  const Json info = Json::parse(bench.mustRun("info all.vdb --json -"));
  const Json* labels = nullptr;
  for (const Json& grid : info.at("grids"))
    if (grid.at("name") == "grain") labels = &grid;
  REQUIRE(labels);
  CHECK(last == std::to_string(labels->at("metadata").at("madf_grains").get<int>()));
  CHECK(bench.mustRun("hierarchy all.vdb -") == table);
  bench.mustRun("segment s.vdb all.slabs --slab-height 16 --keep manifold");
  bench.mustRun("hierarchy all.slabs cut.csv");
  CHECK(bench.bytes("cut.csv") == table);

  bench.mustRun("segment s.vdb grains.vdb");
  const Outcome none = bench.run("hierarchy grains.vdb joins.csv");
  CHECK(none.exitCode == 1);
  CHECK(none.err.find("holds no manifolds") != std::string::npos);
  CHECK(bench.bytes("joins.csv") == table);
  CHECK(bench.run("hierarchy all.vdb joins.txt").exitCode == 2);
}

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
  CHECK(bench.mustRun(pair).find("differ in topology") != std::string::npos);
  CHECK(Json::parse(bench.mustRun(pair + " --json -")).at("same_topology") == false);
  CHECK(bench.mustRun(pair + " --grains -") ==
        "side,grain,voxels,partner,overlap_voxels,intersection_over_union,pieces\n"
        "truth,1,2,1,1,0.5,1\ntruth,2,2,2,2,1,1\ntest,1,1,1,1,0.5,1\ntest,2,2,2,2,1,1\n");
  CHECK(bench.mustRun(pair + " --confusion -") == "truth,test,voxels\n1,0,1\n1,1,1\n2,2,2\n");

  CHECK(bench.mustRun(pair).find("domains differ") == std::string::npos);
  bench.mustRun("convert a.raw a.npy --dims 4x1x1 --type uint8");
  bench.mustRun("convert a.raw longer.npy --dims 2x2x1 --type uint8");
  CHECK(bench.mustRun("compare a.npy longer.npy").find("domains differ") != std::string::npos);
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
    bench.mustRun("convert g.vdb g.raw");
    CHECK(bench.bytes("g.raw") == std::string(4 * 64, '\0'));
  }
  bench.mustRun(kSnow + "s.raw");
  for (const char* verb : {"segment", "convert"}) {
    const std::string command = std::string(verb) + " s.raw out.vdb --dims 48x48x48 --type uint8 ";
    const Outcome nothing = bench.run(command + "--phase 9");
    CHECK(nothing.exitCode == 0);
    CHECK(nothing.out.find("nothing is selected") != std::string::npos);
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
