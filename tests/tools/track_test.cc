// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verb track, run as a user runs it; what it finds: matching/track_test.cc.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/csv_table.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// The cells of a table, without its header.
std::vector<std::vector<std::string>> rows(const std::string& csv) {
  std::vector<std::vector<std::string>> table;
  std::istringstream lines(csv);
  std::string line;
  for (std::getline(lines, line); std::getline(lines, line);) {
    table.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) table.back().push_back(cell);
  }
  return table;
}

/// Grains of snow, and the same a little later: two are one, one has come apart, one is gone.
void makeSeries(const Bench& bench) {
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb a.vdb --keep manifold --merge both --theta -0.3");
  bench.mustRun("edit a.vdb b.vdb --merge 1,2 --split 3 --drop 4 --renumber");
}

}  // namespace

TEST_CASE("cli: what was edited between two scans is told", "[cli]") {
  const Bench bench;
  makeSeries(bench);
  const Json json = Json::parse(
      bench.mustRun("track a.vdb b.vdb t.vdb --grains g.csv --links l.csv --bonds o.csv --json -"));
  CHECK(json.at("shift") == Json{0, 0, 0});
  const Json before = json.at("grains_before"), after = json.at("grains_after");
  CHECK(before.at("merged") == 2);
  CHECK(before.at("split") == 1);
  CHECK(before.at("vanished") == 1);
  CHECK(before.at("kept") == before.at("all").get<int>() - 4);
  CHECK(after.at("merged") == 1);
  CHECK(after.at("split") == 2);
  CHECK(after.count("new") == 0);
  CHECK(after.at("kept") == before.at("kept"));
  CHECK(json.at("common_voxels") == json.at("voxels_after"));
  int kept = 0, inside = 0, afterRows = 0;
  for (const auto& row : rows(bench.bytes("g.csv"))) {
    REQUIRE(row.size() == 10);
    kept += row[2] == "kept";
    afterRows += row[0] == "after";
    if (row[0] == "before" && row[1] == "4") CHECK(row[2] == "vanished");
    if (row[2] == "kept") CHECK(row[9] == "1");
  }
  CHECK(kept == 2 * before.at("kept").get<int>());
  CHECK(afterRows == after.at("all"));
  for (const auto& row : rows(bench.bytes("o.csv"))) inside += row.back() == "inside";
  const Json bonds = json.at("bonds_before"), later = json.at("bonds_after");
  CHECK(inside == bonds.value("inside", 0) + later.value("inside", 0));
  CHECK(rows(bench.bytes("l.csv")).size() == size_t(after.at("all")) + 1);

  // The labels have the numbers of before: tracked again, every grain has its own.
  bench.mustRun("track a.vdb t.vdb --grains h.csv -q");
  for (const auto& row : rows(bench.bytes("h.csv")))
    if (row[0] == "after") CHECK(row[3] == row[1]);
  CHECK(gridOf(infoOf(bench, "t.vdb"), "grain").at("metadata").at("madf_track") == "shift 0,0,0");
  CHECK(bench.mustRun("track a.vdb b.vdb").find("1 split, 2 merged, 1 vanished") !=
        std::string::npos);
  bench.mustRun("track a.vdb b.vdb one.vdb --threads 1 -q");
  CHECK(bench.bytes("one.vdb") == bench.bytes("t.vdb"));
}

TEST_CASE("cli: a sample that moved is found, in images too", "[cli]") {
  const Bench bench;
  makeSeries(bench);
  bench.mustRun("convert a.vdb a.npy --grid grain");
  bench.mustRun("convert b.vdb part.vdb --grid grain --labels --crop 5,0,9:47,47,47");
  bench.mustRun("convert part.vdb b.npy -q");  // begins at its own corner
  const Json json = Json::parse(bench.mustRun("track a.npy b.npy t.tif --json -"));
  CHECK(json.at("shift") == Json{-5, 0, -9});
  CHECK(json.at("common_voxels") == json.at("voxels_after"));
  CHECK(json.at("grains_before").at("outside").get<int>() > 0);
  CHECK(json.at("grains_after").count("new") == 0);
  bench.mustRun("track a.npy b.npy u.tif --shift -5,0,-9 -q");
  CHECK(bench.bytes("t.tif") == bench.bytes("u.tif"));
  // Said where what is found may not be the best.
  const Outcome near = bench.run("track a.npy b.npy --max-shift 9 -q");
  CHECK(near.exitCode == 0);
  const Outcome told = bench.run("track a.npy b.npy --max-shift 9");
  CHECK_THAT(told.err,
             vdb_madf::test::Contains("b.npy: the shift is the largest that is looked for"));
}

TEST_CASE("cli: what cannot be tracked is told in a line", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb --voxel-size 10um");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun(kSpheres + "other.vdb --voxel-size 20um");
  bench.mustRun("convert s.vdb mask.vdb --grid object --phase 1");
  refuses(bench, kFailed, "track g.vdb other.vdb", {"other.vdb", "2 times as long", "g.vdb"});
  refuses(bench, kFailed, "track mask.vdb g.vdb", {"mask.vdb", "labels (int32)"});
  refuses(bench, kFailed, "track g.vdb s.vdb --after-grid snow", {"s.vdb", "'snow'"});
  refuses(bench, kFailed, "track g.vdb s.vdb --shift 900,0,0", {"s.vdb", "g.vdb", "--shift"});
  bench.mustRun("track g.vdb s.vdb --after-grid truth --shift 0,0,0 -q");
}

TEST_CASE("cli: a sample that was turned and shortened is followed", "[cli]") {
  const Bench bench;
  // Balls at random places, of the same numbers, before and after.
  std::mt19937 random(3);
  std::vector<std::array<double, 3>> centers;
  while (centers.size() < 60) {
    std::array<double, 3> p;
    for (double& value : p) value = double(random() % 6000) / 100;
    const bool isFree = std::all_of(centers.begin(), centers.end(), [&](const auto& q) {
      return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) > 10.5;
    });
    if (isFree) centers.push_back(p);
  }
  std::ostringstream before, after;
  const double cosine = 0.98, sine = std::sqrt(1 - cosine * cosine);
  for (const auto& p : centers) {
    before << p[0] << ' ' << p[1] << ' ' << p[2] << " 5\n";
    after << cosine * p[0] - sine * p[1] << ' ' << sine * p[0] + cosine * p[1] << ' ' << 0.9 * p[2]
          << " 5\n";
  }
  bench.write("before.txt", before.str());
  bench.write("after.txt", after.str());
  for (const std::string side : {"before", "after"})
    bench.mustRun("generate balls " + side + ".txt " + side + ".vdb --radius 1");
  const std::string pair = "track before.vdb after.vdb --before-grid truth --after-grid truth ";
  for (const std::string kind : {"rigid", "affine", "free"}) {
    const Json json = Json::parse(bench.mustRun(pair + "t.vdb --motion " + kind +
                                                " --grains g.csv --bonds b.csv --json - -q"));
    CHECK(json.at("motion") == kind);
    CHECK(json.at("grains_before").at("kept") == 60);
    CHECK(json.count("shift") == 0);
    const auto table = rows(bench.bytes("g.csv"));
    REQUIRE(table.size() == 120);
    for (const auto& row : table) {
      REQUIRE(row.size() == 27);
      CHECK(row[2] == "kept");
      CHECK(row[3] == row[1]);
      CHECK(std::abs(std::stod(row[20]) - 0.9) < 0.05);   // f_zz
      CHECK(std::abs(std::stod(row[25]) - 11.48) < 2.5);  // rotation_z
    }
    CHECK(gridOf(infoOf(bench, "t.vdb"), "truth").at("metadata").at("madf_track") ==
          "motion " + kind);
  }
  bench.mustRun(pair + "--motion affine --phi phi.tsv --network moved.csv -q");
  std::istringstream phi(bench.bytes("phi.tsv"));
  std::string line;
  REQUIRE(std::getline(phi, line));
  CHECK(line.find("Label\tZpos\tYpos\tXpos\tFzz\tFzy\tFzx\tZdisp\tFyz") == 0);
  const Table moved(bench.bytes("moved.csv"));
  REQUIRE(moved.rows.size() == centers.size());
  // Both samples begin anew where their first balls do: places are compared with the first one's.
  std::vector<double> first;
  const double turn[3][3] = {{1, 0, 0}, {0, cosine, sine}, {0, -sine, cosine}};  // z, y, x
  for (size_t label = 0; label <= centers.size(); ++label) {
    CAPTURE(label);
    std::vector<double> row(20);
    for (double& value : row) REQUIRE(phi >> value);
    CHECK(row[0] == double(label));
    CHECK(row[18] == (label == 0 ? -1 : 2));
    if (label == 0) continue;
    if (first.empty()) first = row;
    std::array<double, 3> way{};  // from the first one
    for (size_t axis = 0; axis < 3; ++axis) way[axis] = centers[label - 1][axis] - centers[0][axis];
    const double change[] = {-0.1 * way[2], sine * way[0] + (cosine - 1) * way[1],
                             (cosine - 1) * way[0] - sine * way[1]};
    for (size_t axis = 0; axis < 3; ++axis) {
      CHECK(std::abs(row[1 + axis] - first[1 + axis] - way[2 - axis]) < 0.3);
      CHECK(std::abs(row[7 + 4 * axis] - first[7 + 4 * axis] - change[axis]) < 0.4);
      for (size_t column = 0; column < 3; ++column)
        CHECK(std::abs(row[4 + 4 * axis + column] - turn[axis][column]) < 0.05);
    }
    const size_t n = label - 1;
    CHECK(moved.at(n, "pore.coords[2]") == Approx(row[1]));
    CHECK(moved.at(n, "pore.displacement_z") == Approx(row[7]));
    CHECK(moved.at(n, "pore.fate") == 0);
    CHECK(moved.at(n, "pore.partner") == double(label));
  }
  // Displacements are those between images of the labels, which begin where their boxes do.
  const auto box = gridOf(infoOf(bench, "before.vdb"), "truth").at("metadata");
  const auto corner = [&](const std::string& which, int add) {
    std::string text;
    for (const int64_t value : box.at("madf_domain_" + which))
      text += (text.empty() ? "" : ",") + std::to_string(value + add);
    return text;
  };
  bench.mustRun("convert before.vdb cut.vdb --grid truth --labels --crop " + corner("min", 3) +
                ":" + corner("max", 0) + " -q");
  bench.mustRun("track cut.vdb after.vdb --after-grid truth --motion affine --phi cut.tsv -q");
  const auto phiOf = [&](const std::string& file) {
    std::istringstream text(bench.bytes(file));
    std::string head;
    std::getline(text, head);
    std::vector<std::vector<double>> all(1, std::vector<double>(20));
    while (std::all_of(all.back().begin(), all.back().end(),
                       [&](double& v) { return bool(text >> v); }))
      all.emplace_back(20);
    return all;
  };
  const auto wholePhi = phiOf("phi.tsv"), cutPhi = phiOf("cut.tsv");
  int compared = 0;
  for (size_t n = 1; n + 1 < cutPhi.size(); ++n) {
    if (std::abs(cutPhi[n][1] + 3 - wholePhi[n][1]) > 0.01) continue;  // not seen whole
    ++compared;
    for (const size_t axis : {7, 11, 15})
      CHECK(std::abs(cutPhi[n][axis] - wholePhi[n][axis] - 3) < 0.3);
  }
  CHECK(compared > 20);
  refuses(bench, kWrongUsage, pair + "--phi phi.tsv", {"phi.tsv", "--motion"});
  refuses(bench, kWrongUsage, pair + "--network n.vtp", {"n.vtp", "--motion"});
  refuses(bench, kWrongUsage, pair + "--motion free --network n.txt", {"n.txt", ".graphml"});
  refuses(bench, kWrongUsage, pair + "--motion affine --phi phi.csv", {"phi.csv", ".tsv"});
  const std::string told = bench.mustRun(pair + "--motion affine");
  CHECK(told.find("turned by 11.") != std::string::npos);
  bench.write("guess.txt", "0.98 -0.2 0 0\n0.2 0.98 0 0\n0 0 0.9 0\n");
  CHECK(bench.mustRun(pair + "--motion guess.txt").find(" 60 kept") != std::string::npos);
  bench.write("bad.txt", "1 0 0 0 1 0 0 0 1\n");
  refuses(bench, kFailed, pair + "--motion bad.txt", {"bad.txt", "9 numbers", "12 in all"});
  bench.write("bad.txt", "1 0 0 0 0 1 0 0 0 0 -1 0\n");
  refuses(bench, kFailed, pair + "--motion bad.txt", {"bad.txt", "above 0"});
  refuses(bench, kFailed, pair + "--motion none.txt", {"none.txt"});
  refuses(bench, kWrongUsage, pair + "scene.zarr --motion free", {"scene.zarr", "rigid or affine"});
  bench.mustRun(kSpheres + "other.vdb");
  refuses(bench, kFailed,
          "track before.vdb other.vdb --before-grid truth --after-grid truth --motion free",
          {"other.vdb", "no motion is found"});
}

TEST_CASE("cli: a simple shear of a nearly regular pack is found to a thousandth", "[cli]") {
  const Bench bench;
  constexpr double kShear = 0.12;  // of x along z
  std::mt19937 random(8);
  std::ostringstream before, after;
  for (int n = 0; n < 343; ++n) {  // near the points of a lattice
    double p[3];
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = 13 * (n / (axis == 0 ? 1 : axis == 1 ? 7 : 49) % 7) + double(random() % 200) / 100;
    before << p[0] << ' ' << p[1] << ' ' << p[2] << " 5\n";
    after << p[0] + kShear * p[2] << ' ' << p[1] << ' ' << p[2] << " 5\n";
  }
  bench.write("before.txt", before.str());
  bench.write("after.txt", after.str());
  for (const std::string side : {"before", "after"})
    bench.mustRun("generate balls " + side + ".txt " + side + ".vdb --radius 1 -q");
  const Json json = Json::parse(
      bench.mustRun("track before.vdb after.vdb --before-grid truth --after-grid truth --motion "
                    "affine --grains g.csv --json - -q"));
  CHECK(json.at("grains_before").at("kept") == 343);
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 3; ++column) {
      const double truth = row == column ? 1 : row == 0 && column == 2 ? kShear : 0;
      CHECK(std::abs(json.at("motion_of_whole")[row][column].get<double>() - truth) < 1e-3);
    }
  double sum = 0;
  for (const auto& row : rows(bench.bytes("g.csv"))) sum += std::stod(row[14]);  // f_xz
  CHECK(std::abs(sum / 686 - kShear) < 1e-3);
}

TEST_CASE("cli: a pair of scans becomes a scene of OME-Zarr", "[cli]") {
  const Bench bench;
  makeSeries(bench);
  const std::string printed = bench.mustRun("track a.vdb b.vdb scene.ome.zarr --grains g.csv");
  CHECK(printed == bench.mustRun("track a.vdb b.vdb tracked.vdb --grains other.csv"));
  CHECK(bench.bytes("g.csv") == bench.bytes("other.csv"));
  const Json root = Json::parse(bench.bytes("scene.ome.zarr/zarr.json"));
  const Json scene = root.at("attributes").at("ome");
  CHECK(scene.at("version") == "0.6");
  CHECK(scene.at("scene").at("coordinateTransformations").at(0).at("translation") ==
        Json({0.0, 0.0, 0.0}));
  bench.mustRun("convert scene.ome.zarr before.npy --dataset before/labels/grain --type int32");
  bench.mustRun("convert scene.ome.zarr after.npy --dataset after/labels/grain --type int32");
  bench.mustRun("convert a.vdb a.npy --grid grain");
  bench.mustRun("convert tracked.vdb tracked.npy --grid grain");
  CHECK(bench.bytes("before.npy") == bench.bytes("a.npy"));
  CHECK(bench.bytes("after.npy") == bench.bytes("tracked.npy"));
  bench.mustRun("track a.vdb b.vdb one.zarr --threads 1 -q");
  for (const std::string file :
       {"/zarr.json", "/before/zarr.json", "/after/labels/grain/0/zarr.json"})
    CHECK(bench.bytes("one.zarr" + file) == bench.bytes("scene.ome.zarr" + file));
  refuses(bench, kFailed, "track a.vdb b.vdb scene.ome.zarr", {"scene.ome.zarr", "already"});
}

TEST_CASE("cli: a series of scans keeps one number a grain", "[cli]") {
  const Bench bench;
  makeSeries(bench);
  bench.mustRun("edit b.vdb c.vdb --drop 2 --renumber");
  const std::string told = bench.mustRun("track a.vdb b.vdb c.vdb out");
  CHECK(told.find("b.vdb") < told.find("c.vdb"));
  bench.mustRun("track a.vdb b.vdb step.vdb --grains g.csv --bonds o.csv -q");
  CHECK(bench.bytes("out/b.vdb") == bench.bytes("step.vdb"));
  CHECK(bench.bytes("out/b_grains.csv") == bench.bytes("g.csv"));
  CHECK(bench.bytes("out/b_bonds.csv") == bench.bytes("o.csv"));
  bench.mustRun("track step.vdb c.vdb next.vdb --grains g.csv -q");
  CHECK(bench.bytes("out/c.vdb") == bench.bytes("next.vdb"));
  CHECK(bench.bytes("out/c_grains.csv") == bench.bytes("g.csv"));
  refuses(bench, kWrongUsage, "track a.vdb b.vdb c.vdb out --grains g.csv", {"g.csv", "folder"});
  // Each scan is read as it has to be: a layout is of those alone that do not tell theirs.
  bench.mustRun("convert a.vdb a.raw --grid grain -q");
  bench.mustRun("convert c.vdb c.raw --grid grain -q");
  bench.mustRun("track a.raw b.vdb c.raw raws --dims 48x48x48 --type int32 -q");
  CHECK(bench.bytes("raws/c_grains.csv") == bench.bytes("g.csv"));
  refuses(bench, kWrongUsage, "track a.vdb b.vdb b.vdb other", {"b.vdb"});
  refuses(bench, kWrongUsage, "track a.vdb b.vdb c.vdb .", {"b.vdb"});
  refuses(bench, kFailed, "track a.vdb b.vdb none.vdb other", {"none.vdb"});
  bench.write("c.vdb", "nothing");
  for (const std::string folder : {"out", "new"}) {
    const Outcome outcome = bench.run("track a.vdb b.vdb c.vdb " + folder);
    CHECK(outcome.exitCode == kFailed);
    CHECK((outcome.err.find("of an earlier run") != std::string::npos) == (folder == "out"));
  }
  CHECK(bench.bytes("new/b.vdb") == bench.bytes("step.vdb"));
}

TEST_CASE("cli: a series that was made to move is followed as it moved", "[cli]") {
  const Bench bench;
  bench.mustRun("generate particles p.vdb --size 72 --count 70 --radius 6:9");
  const std::string evolve =
      " --steps 2 --strain 0.16 --turn 10 --axis 1,2,2 --drift 2.5,0,-1 --rigid-grains --vanish "
      "0.1 --noise 0.3 --enter 0.05 --break 0.1 --break-gap 3 --grow 0.5";
  const std::string told = bench.mustRun("generate evolve p.vdb scans" + evolve);
  CHECK(told.find("step-2.vdb: ") != std::string::npos);
  bench.mustRun("generate evolve p.vdb again --threads 1 -q" + evolve);
  for (const std::string file :
       {"/step-0.vdb", "/step-2.vdb", "/motion.csv", "/fates.csv", "/bonds.csv"})
    CHECK(bench.bytes("scans" + file) == bench.bytes("again" + file));
  bench.mustRun(
      "track scans/step-0.vdb scans/step-1.vdb scans/step-2.vdb tracks --motion affine -q");

  const auto motion = rows(bench.bytes("scans/motion.csv"));
  REQUIRE(motion.size() == 3);
  std::map<std::string, std::string> fates;  // of the last step
  for (const auto& row : rows(bench.bytes("scans/fates.csv")))
    if (row[0] == "2") fates[row[1]] = row[2];
  int kept = 0, right = 0, wrong = 0;
  for (const auto& [grain, fate] : fates) kept += fate == "kept";
  CHECK(kept > 20);
  CHECK(kept < int(fates.size()) - 10);
  for (const auto& row : rows(bench.bytes("tracks/step-2_grains.csv"))) {
    if (row[0] != "after" || row[2] != "kept") continue;
    right += row[1] == row[3] && fates.at(row[1]) == "kept";
    wrong += row[1] != row[3] && fates.count(row[3]);  // what entered or was lost has a new number
  }
  CHECK(right > 0.9 * kept);
  CHECK(wrong == 0);
  // In slabs it is the same.
  for (const std::string step : {"1", "2"})
    for (const std::string ending : {".vdb", ".slabs --slab-height 16"})
      bench.mustRun("segment scans/step-" + step + ".vdb " + step + ending + " -q");
  for (const std::string ending : {".vdb", ".slabs"})
    bench.mustRun("track 1" + ending + " 2" + ending + " 3" + ending +
                  " --motion affine --grains 3" + ending + ".csv --bonds b" + ending +
                  ".csv --network n" + ending + ".csv -q");
  bench.mustRun("track 1.slabs 2.slabs 4.tif --motion affine -q");
  for (const std::string table : {"3", "b", "n"})
    CHECK(bench.bytes(table + ".slabs.csv") == bench.bytes(table + ".vdb.csv"));
  for (const std::string made : {"3.slabs", "4.tif"})
    CHECK(bench.mustRun("compare 3.vdb " + made).find("only 0, in test only 0") !=
          std::string::npos);
  bench.mustRun("track 1.slabs 2.slabs/ 3.slabs/ later/ --motion affine -q");
  CHECK(bench.bytes("later/2_grains.csv") == bench.bytes("3.vdb.csv"));
  CHECK(infoOf(bench, "later/3.slabs").at("grids").size() == 1);
  refuses(bench, kFailed, "track 1.slabs 2.slabs none/5.slabs --motion affine", {"none"});

  refuses(bench, kFailed, "generate evolve none.vdb other", {"none.vdb"});
  refuses(bench, kWrongUsage, "generate evolve scans/step-1.vdb scans", {"step-1.vdb"});
}
