// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Where tables come from, what `vdb_madf measure` refuses, and what it measures on demand.

#include <algorithm>
#include <filesystem>
#include <string>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/csv_table.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

TEST_CASE("cli: sample.json tells where the labels come from and how they were made", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow --size 48 --length 14 --voxel-size 10um snow.tif");
  bench.mustRun(
      "segment snow.tif g.vdb --gamma 20 --merge both --theta -0.7 --delta 4 --fill-holes 9 --tidy "
      "1");
  bench.mustRun("measure g.vdb t --sample first");
  const Json sample = Json::parse(bench.bytes("t/sample.json"));
  CHECK(sample.at("sample") == "first");
  CHECK(sample.at("labels") == "g.vdb");
  CHECK(sample.at("grid") == "grain");
  const Json& made = sample.at("segmentation");
  CHECK(made.at("source") == "snow.tif");
  CHECK(made.at("gamma") == 20);
  CHECK(made.at("theta") == -0.7);
  CHECK(made.at("delta") == 4);
  CHECK(made.at("fill_holes") == 9);
  CHECK(made.at("tidy") == 1);
  CHECK(made.at("merge") == "both");
  CHECK(made.at("boundary") == "open");
  CHECK(made.at("version") == sample.at("version"));
  const Table grains(bench.bytes("t/grains.csv")), bonds(bench.bytes("t/bonds.csv"));
  for (const Table* table : {&grains, &bonds}) {
    CHECK(table->names.at(0) == "sample");
    for (const auto& row : table->rows) CHECK(row.at(0) == "first");
  }
  // The labels have one digest in each format, and other labels another.
  bench.mustRun("convert g.vdb g.npy --grid grain");
  bench.mustRun("measure g.npy same --boundary open");
  bench.mustRun("segment snow.tif other.vdb --tables other");
  const auto digest = [&](const std::string& folder) {
    return Json::parse(bench.bytes(folder + "/sample.json")).at("labels_digest");
  };
  CHECK(digest("same") == digest("t"));
  CHECK(digest("other") != digest("t"));
}

TEST_CASE("cli: measure refuses, and leaves nothing behind", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 40 --count 4 --radius 6:8 balls.vdb");
  bench.write("file", "");
  const auto names = bench.names();
  CHECK(bench.run("measure balls.vdb").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --density 0.917").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --density ice").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --density 900 --ice").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --min-faces -1").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --min-faces few").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --unit km").exitCode == 2);
  const std::string unknown = bench.run("measure balls.vdb out --unit um").err;
  CHECK(unknown.find("the voxel size is unknown") != std::string::npos);
  CHECK(unknown.find("(--voxel-size)") != std::string::npos);
  CHECK(bench.run("measure balls.vdb out --grid none").exitCode == 1);
  CHECK(bench.run("measure missing.vdb out").exitCode == 1);
  CHECK(bench.run("measure balls.vdb file").exitCode == 1);
  CHECK(bench.run("measure balls.vdb none/out").exitCode == 1);
  const Outcome outside = bench.run("measure balls.vdb out --domain 0,0,0:3,3,3");
  CHECK(outside.exitCode == 1);
  CHECK(outside.err.find("leaves the domain") != std::string::npos);
  CHECK(bench.names() == names);
}

TEST_CASE(
    "cli: measure adds shapes, weights, gray values and intervals on demand, and changes nothing "
    "else",
    "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 48 --count 9 --radius 6:8 --voxel-size 20um balls.vdb");
  bench.mustRun("convert balls.vdb scan.tif --grid truth --type uint8");
  bench.mustRun("measure balls.vdb plain");
  const std::string said = bench.mustRun(
      "measure balls.vdb all --shape --edge-weights --crossing --voronoi --bootstrap 100 "
      "--intensity "
      "scan.tif");
  CHECK(said.find("corrected diameter") != std::string::npos);
  CHECK(said.find("  mean_coordination  ") != std::string::npos);
  const Table plain(bench.bytes("plain/grains.csv")), all(bench.bytes("all/grains.csv")),
      bonds(bench.bytes("all/bonds.csv"));
  REQUIRE(all.rows.size() == plain.rows.size());
  for (size_t i = 0; i < plain.rows.size(); ++i) {
    CHECK(std::equal(plain.rows[i].begin(), plain.rows[i].end(), all.rows[i].begin()));
    CHECK(all.at(i, "gray_min") == all.at(i, "id"));  // the scan is that of the labels
    CHECK(all.at(i, "gray_max") == all.at(i, "id"));
    CHECK(all.at(i, "feret_max_mm") > all.at(i, "feret_min_mm"));
    CHECK(all.at(i, "local_solid_fraction") ==
          Approx(all.at(i, "volume_mm3") / all.at(i, "cell_volume_mm3")));
    CHECK((all.at(i, "edge_weight") == 0) == (all.at(i, "at_domain_face") == 1));
  }
  CHECK(all.sum("cell_volume_mm3") == Approx(48 * 48 * 48 * 8e-6));  // the whole box
  for (size_t i = 0; i < bonds.rows.size(); ++i) {
    CHECK(bonds.at(i, "gray_min") == bonds.at(i, "first"));
    CHECK(bonds.at(i, "gray_max") == bonds.at(i, "second"));
  }
  const Json before = Json::parse(bench.bytes("plain/sample.json")),
             after = Json::parse(bench.bytes("all/sample.json"));
  for (const auto& [key, value] : before.items()) CHECK(after.at(key) == value);
  CHECK(after.at("grain_diameter_mean_interval_mm").at("mean") ==
        after.at("grain_diameter_mean_mm"));
  CHECK(said.find("  minimum cut         x ") != std::string::npos);
  for (const std::string axis : {"x", "y", "z"}) {
    double cut = 0;
    for (size_t i = 0; i < bonds.rows.size(); ++i)
      cut += bonds.at(i, "cut_" + axis) * bonds.at(i, "area_mm2");
    CHECK(after.at("minimum_cut_area_" + axis + "_mm2").get<double>() == Approx(cut).margin(1e-12));
    CHECK(after.at("bond_conductivity_" + axis) < after.at("solid_fraction"));
  }
  CHECK_FALSE(before.contains("bond_conductivity_x"));
  CHECK_FALSE(before.contains("corrected_grains"));
  CHECK_FALSE(before.contains("bootstrap_replicates"));
  bench.mustRun("measure balls.vdb again --intensity balls.vdb --intensity-grid truth --threads 1");
  CHECK(Table(bench.bytes("again/grains.csv")).sum("gray_mean") == all.sum("gray_mean"));
  bench.mustRun("collect all all.csv -q");
  const Table collected(bench.bytes("all.csv"));
  CHECK(collected.at(0, "grain_diameter_mean_interval_low_mm") ==
        Approx(after.at("grain_diameter_mean_interval_mm").at("low").get<double>()));
}

TEST_CASE("cli: measure refuses scans and options that do not fit its labels", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 30 --count 4 --radius 5:6 balls.vdb");
  for (const std::string size : {"29", "31"}) {
    bench.mustRun("generate spheres --size " + size + " --count 4 --radius 5:6 other.vdb");
    bench.mustRun("convert other.vdb other" + size + ".tif --grid truth --type uint8");
  }
  bench.mustRun("convert balls.vdb scan.npy --grid truth --type uint8");
  bench.mustRun("convert balls.vdb scan.raw --grid truth --type uint8");
  const std::string bytes = bench.bytes("scan.npy");
  bench.write("cut.npy", bytes.substr(0, bytes.size() / 2));
  const std::string measure = "measure balls.vdb out ";
  refuses(bench, kFailed, measure + "--intensity other29.tif",
          {"other29.tif: has 29x29x29 voxels", "of a scan of 30x30x30 voxels: give the one that"});
  // Labels of our own say where they lie in a larger scan, those of an image do not.
  bench.mustRun("segment balls.vdb own.vdb --grid object");
  CHECK(bench.run("measure own.vdb out --intensity other31.tif")
            .err.find("other31.tif: is larger than the volume of the labels") != std::string::npos);
  bench.mustRun("convert own.vdb part.tif --labels --crop 5,5,5:24,24,24 -q");
  for (const std::string verb :
       {"measure part.tif out --intensity other31.tif", "measure part.tif out --gray other31.tif",
        "measure part.tif out --phases other31.tif --bridges b.csv",
        "render part.tif out.png --overlay other31.tif",
        "report part.tif out.html --overlay other31.tif"})
    refuses(bench, kFailed, verb,
            {"other31.tif: has 31x31x31 voxels, and the labels, of 20x20x20 voxels, do not say "
             "where in it they were cropped: give the scan cropped as they were"});
  bench.mustRun("convert balls.vdb coarse.tif --grid truth --type uint8 --voxel-size 20um");
  CHECK(bench.run(measure + "--intensity coarse.tif").err.find("voxels of") == std::string::npos);
  bench.mustRun("convert balls.vdb fine.vdb --grid truth --voxel-size 8.5um");
  CHECK(bench.run("measure fine.vdb out --grid truth --intensity coarse.tif")
            .err.find("coarse.tif: has voxels of 20 um, and the labels of 8.5 um") !=
        std::string::npos);
  std::filesystem::remove_all(bench.path("out"));
  refuses(bench, kFailed, measure + "--intensity cut.npy", {"cut.npy"});
  refuses(bench, kFailed, measure + "--intensity nothing.tif", {"nothing.tif"});
  refuses(bench, kFailed, measure + "--intensity other.vdb --intensity-grid fog",
          {"no grid 'fog'"});
  refuses(bench, kFailed, measure + "--intensity scan.npy --intensity-grid fog", {"scan.npy"});
  refuses(bench, kWrongUsage, measure + "--intensity scan.raw", {"convert it to .tif or .npy"});
  refuses(bench, kWrongUsage, measure + "--intensity -", {"is read from a file"});
  refuses(bench, kWrongUsage, measure + "--intensity-grid fog", {"give --intensity, too"});
  refuses(bench, kWrongUsage, measure + "--bootstrap 99", {"--bootstrap 99", "100 to 100000"});
  refuses(bench, kFailed, measure + "--edge-weights --boundary closed",
          {"balls.vdb", "boundary is closed"});
  refuses(bench, kFailed, measure + "--gray scan.npy", {"scan.npy: its edges tell no blur"});
  refuses(bench, kFailed, measure + "--gray nothing.tif", {"nothing.tif"});
  refuses(bench, kWrongUsage, measure + "--gray-grid fog", {"give --gray, too"});
  refuses(bench, kWrongUsage, measure + "--sensitivity 20", {"give it with --gray SCAN"});
  refuses(bench, kWrongUsage, measure + "--vary gamma:3", {"--sensitivity"});
  const std::string again = measure + "--gray scan.npy --sensitivity ";
  refuses(bench, kWrongUsage, again + "4", {"from 5 to 1000"});
  refuses(bench, kWrongUsage, again + "9 --vary fog:1", {"threshold:T,smooth:S"});
  refuses(bench, kWrongUsage, again + "9 --vary smooth", {"--vary smooth"});
  refuses(bench, kWrongUsage, again + "9 --vary smooth:-1", {"0 or more"});
  refuses(bench, kWrongUsage, again + "9 --vary strictness:1e6", {"1e6", "at most 200000"});
  refuses(bench, kFailed, "measure nosuch.slabs out --stability", {"nosuch.slabs", "cannot be"});
}

TEST_CASE("cli: measure writes curves of sizes, and their distance from another", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 40 --count 5 --radius 5:7 --voxel-size 20um balls.vdb");
  bench.write("sieves.csv", "size_um,percent_passing\n200,5\n240,50\n300,95\n");
  const std::string said = bench.mustRun(
      "measure balls.vdb out --size-curve curve.csv --size-reference sieves.csv --sample S");
  CHECK(said.find("  feret_min           RMS ") != std::string::npos);
  const std::string curve = bench.bytes("curve.csv");
  CHECK(curve.substr(0, curve.find('\n')) ==
        "sample,percent_passing,equivalent_diameter_mm,axis2_length_mm,feret_min_mm,"
        "projected_diameter_mm");
  CHECK(std::count(curve.begin(), curve.end(), '\n') == 102);
  CHECK(Json::parse(bench.bytes("out/sample.json")).at("size_curve_rms_percent").size() == 4);
  CHECK(bench.mustRun("measure balls.vdb out --sample S --size-curve -") == curve);
  bench.write("full.raw", std::string(125, '\1'));  // its grain touches all faces
  CHECK(bench
            .mustRun("measure full.raw out --dims 5x5x5 --type uint8 --voxel-size 20um "
                     "--edge-weights --size-reference sieves.csv")
            .find("  feret_min           unknown: no grain counts") != std::string::npos);

  refuses(bench, kWrongUsage, "measure balls.vdb out --size-curve curve.txt", {"must be .csv"});
  refuses(bench, kWrongUsage, "measure balls.vdb out --size-curve a.csv --size-reference a.csv",
          {"would overwrite the input"});
  refuses(bench, kFailed, "measure balls.vdb out --size-reference nothing.csv", {"nothing.csv"});
  refuses(bench, kFailed, "measure balls.vdb out --size-reference curve.csv",
          {"curve.csv: a curve of sizes begins with the line size_mm,percent_passing"});
  bench.write("voxels.csv", "size_voxel,percent_passing\n10,50\n");
  refuses(bench, kFailed, "measure balls.vdb out --size-reference voxels.csv", {"are in voxels"});
}

TEST_CASE("cli: measure tells the binder of grains by a map of phases", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 40 --count 5 --radius 5:7 balls.vdb");
  bench.mustRun("generate spheres --size 39 --count 5 --radius 5:7 other.vdb");
  bench.mustRun("convert balls.vdb map.tif --grid object --type uint8 --invert");
  bench.mustRun("convert other.vdb other.tif --grid object --type uint8");
  const std::string said =
      bench.mustRun("measure balls.vdb out --phases map.tif --bridges bridges.csv");
  CHECK(said.find("  binder              ") != std::string::npos);
  const Table bridges(bench.bytes("bridges.csv"));
  REQUIRE(!bridges.rows.empty());  // all pores are binder
  const Json sample = Json::parse(bench.bytes("out/sample.json"));
  const double pores = 40.0 * 40 * 40 - sample.at("object_voxels").get<double>();
  CHECK(bridges.sum("voxels") == pores);
  CHECK(sample.at("binder_volume_voxel3") == Approx(pores));
  CHECK(sample.at("bridges") == bridges.rows.size());
  const auto none =
      bench.run("measure balls.vdb out --phases map.tif --bridges none.csv --binder 3");
  CHECK(none.exitCode == 0);
  CHECK(none.err.find("map.tif: no voxel outside of the grains has the value 3") !=
        std::string::npos);
  CHECK(Table(bench.bytes("none.csv")).rows.empty());

  const std::string measure = "measure balls.vdb out ";
  refuses(bench, kWrongUsage, measure + "--phases map.tif", {"go together: give both"});
  refuses(bench, kWrongUsage, measure + "--bridges b.csv", {"go together: give both"});
  refuses(bench, kWrongUsage, measure + "--phases map.tif --bridges b.csv --binder x",
          {"--binder x"});
  refuses(bench, kWrongUsage, measure + "--binder 2", {"give --phases, too"});
  refuses(bench, kFailed, measure + "--phases other.tif --bridges b.csv",
          {"other.tif: the phases have 39x39x39 voxels, the labels 40x40x40"});
  refuses(bench, kFailed, measure + "--phases nothing.tif --bridges b.csv", {"nothing.tif"});
}

TEST_CASE("cli: measure plots what it measures", "[cli]") {
  const Bench bench;
  bench.mustRun("generate sintered s.vdb --size 40 --count 4 --voxel-size 8.5um");
  for (const auto& [name, begin] : {std::pair<std::string, std::string>{"p.png", "\x89PNG"},
                                    {"p.svg", "<?xml"},
                                    {"p.pdf", "%PDF"}}) {
    bench.mustRun("measure s.vdb tables --plot " + name);
    CHECK(bench.bytes(name).substr(0, begin.size()) == begin);
  }
  const std::string svg = bench.bytes("p.svg");
  bench.mustRun("measure s.vdb tables --plot p.svg --threads 1");
  CHECK((bench.bytes("p.svg") == svg));
  bench.mustRun("measure s.vdb tables --plot p.svg --sample other");
  CHECK((bench.bytes("p.svg") != svg));
  CHECK(bench.run("measure s.vdb tables --plot p.jpg").exitCode == 2);
  CHECK(bench.run("measure s.vdb tables --plot s.vdb").exitCode == 2);
}
