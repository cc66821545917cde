// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verbs that merge manifolds anew, remerge, sweep and hierarchy, run as a user runs them.

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"
#include "support/svg.h"

using namespace vdb_madf::test;

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

TEST_CASE("cli: unequal voxels of an image are swept as they are segmented", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.npy");
  const std::string edges = " --phase 1 --voxel-size 10x10x30um";
  bench.mustRun("sweep s.npy a.csv --strictness 11" + edges);
  const Json json =
      Json::parse(bench.mustRun("segment s.npy g.vdb --keep manifold --json -" + edges));
  const std::string grains = std::to_string(json.at("grains").get<int>());
  CHECK(bench.bytes("a.csv").find("\n0,score,11,,," + grains + ",") != std::string::npos);
  refuses(bench, 2, "sweep g.vdb b.csv --voxel-size 10um", {"leave --voxel-size out"});
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
