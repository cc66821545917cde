// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf measure, run as a user runs it: the three files, their units, and what fits together.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/csv_table.h"

using namespace vdb_madf::test;

namespace {

/// What a column is multiplied with when voxels of edge e become units: e to this power.
int power(const std::string& name) {
  for (const auto& [suffix, exponent] : {std::pair<std::string, int>{"_per_UNIT2", -2},
                                         {"_per_UNIT", -1},
                                         {"_UNIT3", 3},
                                         {"_UNIT2", 2},
                                         {"_UNIT", 1}})
    if (name.size() > suffix.size() &&
        name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0)
      return exponent;
  return 0;
}

std::string renamed(std::string name, const std::string& unit) {
  const size_t at = name.rfind("_" + unit);
  return at == std::string::npos ? name : name.replace(at + 1, unit.size(), "UNIT");
}

void requireScaled(const Table& voxels, const Table& sized, const std::string& unit, double edge) {
  REQUIRE(voxels.names.size() == sized.names.size());
  REQUIRE(voxels.rows.size() == sized.rows.size());
  int scaled = 0;
  for (size_t k = 0; k < voxels.names.size(); ++k) {
    const std::string name = renamed(voxels.names[k], "voxel");
    CAPTURE(name);
    CHECK(name == renamed(sized.names[k], unit));
    scaled += power(name) != 0;
    for (size_t i = 0; i < voxels.rows.size(); ++i) {
      const std::string &a = voxels.rows[i].at(k), &b = sized.rows[i].at(k);
      if (a.empty() || b.empty())
        CHECK(a == b);
      else
        CHECK(std::stod(a) * std::pow(edge, power(name)) ==
              Approx(std::stod(b)).epsilon(1e-7).margin(1e-12));
    }
  }
  CHECK(scaled > 8);
}

/// The tables of grains and bonds, in mm, tell the same; so does the sample's.
void requireSumsFit(const Bench& bench, const std::string& folder) {
  const Table grains(bench.bytes(folder + "/grains.csv")),
      bonds(bench.bytes(folder + "/bonds.csv"));
  const Json sample = Json::parse(bench.bytes(folder + "/sample.json"));
  REQUIRE(bonds.rows.size() > 10);
  CHECK(grains.sum("voxels") == sample.at("object_voxels").get<double>());
  CHECK(grains.sum("shared_area_mm2") == Approx(2 * bonds.sum("area_mm2")));
  CHECK(grains.sum("free_area_mm2") + grains.sum("shared_area_mm2") ==
        Approx(grains.sum("area_mm2")));
  std::map<int, int> coordination;
  std::map<int, double> shared;
  for (size_t i = 0; i < bonds.rows.size(); ++i)
    for (const char* end : {"first", "second"}) {
      ++coordination[int(bonds.at(i, end))];
      shared[int(bonds.at(i, end))] += bonds.at(i, "area_mm2");
    }
  std::vector<int64_t> histogram;
  for (size_t i = 0; i < grains.rows.size(); ++i) {
    const int id = int(grains.at(i, "id"));
    CHECK(id == int(i) + 1);
    CHECK(int(grains.at(i, "coordination")) == coordination[id]);
    CHECK(grains.at(i, "shared_area_mm2") == Approx(shared[id]).margin(1e-12));
    histogram.resize(std::max(histogram.size(), size_t(coordination[id]) + 1));
    ++histogram[size_t(coordination[id])];
  }
  CHECK(sample.at("coordination_distribution").get<std::vector<int64_t>>() == histogram);
  const Json& fabric = sample.at("bond_normal_fabric");
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k) {
      const std::string a = std::string("normal_") + "xyz"[i],
                        b = std::string("normal_") + "xyz"[k];
      double sum = 0;
      for (size_t row = 0; row < bonds.rows.size(); ++row)
        sum += bonds.at(row, "area_mm2") * bonds.at(row, a) * bonds.at(row, b);
      CHECK(fabric.at("tensor").at(i).at(k).get<double>() ==
            Approx(sum / bonds.sum("area_mm2")).margin(1e-8));
      double turned = 0;  // tensor times eigenvector
      for (size_t j = 0; j < 3; ++j)
        turned += fabric.at("tensor").at(i).at(j).get<double>() *
                  fabric.at("eigenvectors").at(k).at(j).get<double>();
      CHECK(turned == Approx(fabric.at("eigenvalues").at(k).get<double>() *
                             fabric.at("eigenvectors").at(k).at(i).get<double>())
                          .margin(1e-9));
    }
}

}  // namespace

TEST_CASE("cli: measure writes tables that fit together", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow --size 64 --length 14 --voxel-size 10um snow.vdb");
  bench.mustRun("segment snow.vdb grains.vdb");
  const std::string said = bench.mustRun("measure grains.vdb tables --ice");
  const Table grains(bench.bytes("tables/grains.csv")), bonds(bench.bytes("tables/bonds.csv"));
  const Json sample = Json::parse(bench.bytes("tables/sample.json"));

  REQUIRE(grains.rows.size() == sample.at("grains").get<size_t>());
  REQUIRE(bonds.rows.size() == sample.at("bonds").get<size_t>());
  REQUIRE(bonds.rows.size() > 10);
  CHECK(said.find(std::to_string(grains.rows.size()) + " grains") != std::string::npos);
  CHECK(sample.at("length_unit") == "mm");
  CHECK(sample.at("voxel_size_mm").get<double>() == Approx(0.01));
  CHECK(grains.sum("voxels") == sample.at("object_voxels").get<double>());
  CHECK(grains.sum("volume_mm3") == Approx(sample.at("object_voxels").get<double>() * 1e-6));
  const double fraction = grains.sum("voxels") / (64.0 * 64 * 64);
  CHECK(sample.at("solid_fraction").get<double>() == Approx(fraction));
  CHECK(sample.at("bulk_density_kg_per_m3").get<double>() == Approx(917 * fraction));
  CHECK(sample.at("specific_surface_per_mm").get<double>() ==
        Approx(grains.sum("free_area_mm2") / grains.sum("volume_mm3")));
  CHECK(sample.at("specific_surface_m2_per_kg").get<double>() ==
        Approx(1e3 * grains.sum("free_area_mm2") / grains.sum("volume_mm3") / 917));
  CHECK(grains.sum("cut_area_mm2") > 0);

  requireSumsFit(bench, "tables");
}

TEST_CASE("cli: measure says nothing of ice or masses unasked", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 40 --count 4 --radius 6:8 --voxel-size 20um balls.vdb");
  const std::string said = bench.mustRun("measure balls.vdb plain"),
                    dense = bench.mustRun("measure balls.vdb dense --density 2650");
  for (const std::string word : {"ice", "kg"}) {
    CHECK(said.find(word) == std::string::npos);
    CHECK(bench.bytes("plain/sample.json").find(word) == std::string::npos);
  }
  CHECK(dense.find("kg/m3") != std::string::npos);
  CHECK(dense.find("m2/kg") != std::string::npos);
  // What the flag is short for.
  bench.mustRun("measure balls.vdb ice --ice");
  bench.mustRun("measure balls.vdb same --density 917");
  CHECK(bench.bytes("ice/sample.json") == bench.bytes("same/sample.json"));
}

TEST_CASE("cli: measure and the network leave out contacts of few faces, and say how many",
          "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow --size 64 --length 14 --voxel-size 10um snow.vdb");
  bench.mustRun("segment snow.vdb grains.vdb");
  bench.mustRun("measure grains.vdb all");
  const std::string said = bench.mustRun("measure grains.vdb some --min-faces 10");
  const Table all(bench.bytes("all/bonds.csv")), some(bench.bytes("some/bonds.csv")),
      allGrains(bench.bytes("all/grains.csv")), grains(bench.bytes("some/grains.csv"));
  const Json sample = Json::parse(bench.bytes("some/sample.json"));
  size_t small = 0, withoutCurvature = 0;
  double area = 0;
  for (size_t i = 0; i < all.rows.size(); ++i) {
    const bool few = all.at(i, "faces") < 10;
    small += few;
    if (few) area += all.at(i, "area_mm2");
    const bool bare = all.at(i, "curvature_points") == 0;
    withoutCurvature += bare;
    CHECK((bare || !few));  // ten points are the fewest
    CHECK(all.rows[i][all.column("mean_curvature_per_mm")].empty() == bare);
  }
  REQUIRE(small > 0);
  REQUIRE(small < all.rows.size());
  CHECK(some.rows.size() == all.rows.size() - small);
  for (size_t i = 0; i < some.rows.size(); ++i) CHECK(some.at(i, "faces") >= 10);
  CHECK(sample.at("min_faces") == 10);
  CHECK(sample.at("contacts_left_out") == small);
  CHECK(sample.at("contacts_left_out_area_mm2").get<double>() == Approx(area));
  CHECK(Json::parse(bench.bytes("all/sample.json")).at("bonds_without_curvature") ==
        withoutCurvature);
  CHECK(said.find(std::to_string(small) + " contact") != std::string::npos);
  CHECK(grains.sum("coordination") == 2 * double(some.rows.size()));
  CHECK(grains.sum("shared_area_mm2") == allGrains.sum("shared_area_mm2"));
  const std::string network = bench.mustRun("export grains.vdb n.graphml --min-faces 10");
  CHECK(network.find(std::to_string(some.rows.size()) + " bond") != std::string::npos);
  CHECK(network.find(std::to_string(small) + " contact") != std::string::npos);
}

TEST_CASE("cli: measure scales with the voxel size", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 60 --count 8 --radius 8:11 balls.vdb");
  const std::string said = bench.mustRun("measure balls.vdb voxels");  // the grid truth
  CHECK(said.find("voxel size          unknown") != std::string::npos);
  bench.mustRun("measure balls.vdb sized --voxel-size 20um --density 900");
  bench.mustRun("measure balls.vdb tiny --voxel-size 5nm -q");
  const Table grains(bench.bytes("voxels/grains.csv")), bonds(bench.bytes("voxels/bonds.csv"));
  requireScaled(grains, Table(bench.bytes("sized/grains.csv")), "mm", 0.02);
  requireScaled(bonds, Table(bench.bytes("sized/bonds.csv")), "mm", 0.02);
  requireScaled(grains, Table(bench.bytes("tiny/grains.csv")), "um", 0.005);
  const Json voxels = Json::parse(bench.bytes("voxels/sample.json")),
             sized = Json::parse(bench.bytes("sized/sample.json"));
  CHECK(voxels.at("length_unit") == "voxel");
  CHECK_FALSE(voxels.contains("specific_surface_m2_per_kg"));
  CHECK(sized.at("specific_surface_per_mm").get<double>() ==
        Approx(voxels.at("specific_surface_per_voxel").get<double>() / 0.02));
  CHECK(sized.at("specific_surface_m2_per_kg").get<double>() ==
        Approx(voxels.at("specific_surface_per_voxel").get<double>() / 20e-6 / 900));
  for (size_t axis = 0; axis < 3; ++axis)
    if (!voxels.at("correlation_length_voxel").at(axis).is_null())
      CHECK(sized.at("correlation_length_mm").at(axis).get<double>() ==
            Approx(0.02 * voxels.at("correlation_length_voxel").at(axis).get<double>()));
  CHECK(sized.at("grain_diameter_by_volume_mm").at("d50").get<double>() ==
        Approx(0.02 * voxels.at("grain_diameter_by_volume_voxel").at("d50").get<double>()));
  CHECK(sized.at("euler_characteristic") == voxels.at("euler_characteristic"));
}

TEST_CASE("cli: measure writes the same bytes with one thread and with three", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack --size 72 --radius 6:12 pack.vdb");
  bench.mustRun("segment pack.vdb grains.vdb");
  bench.mustRun("measure grains.vdb one --threads 1");
  bench.mustRun("measure grains.vdb three --threads 3");
  for (const std::string file : {"grains.csv", "bonds.csv", "sample.json"})
    CHECK(bench.bytes("one/" + file) == bench.bytes("three/" + file));
  // Labels from an image are the same labels.
  bench.mustRun("convert grains.vdb grains.mhd --grid grain --type int32");
  bench.mustRun("measure grains.mhd image");
  CHECK(bench.bytes("one/bonds.csv") == bench.bytes("image/bonds.csv"));
}

TEST_CASE("cli: segment writes the tables that measure writes, with any threads", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack --size 72 --radius 6:12 --voxel-size 10um pack.vdb");
  bench.mustRun("segment pack.vdb one.vdb --tables one --threads 1");
  bench.mustRun("segment pack.vdb two.vdb --tables two --threads 2");
  bench.mustRun("measure one.vdb measured --threads 2");
  for (const std::string file : {"grains.csv", "bonds.csv"})
    CHECK(bench.bytes("one/" + file) == bench.bytes("two/" + file));
  for (const std::string file : {"grains.csv", "bonds.csv", "sample.json"})
    CHECK(bench.bytes("one/" + file) == bench.bytes("measured/" + file));
  Json one = Json::parse(bench.bytes("one/sample.json"));
  CHECK(one.at("labels") == "one.vdb");
  one["labels"] = "two.vdb";
  CHECK(one == Json::parse(bench.bytes("two/sample.json")));
  requireSumsFit(bench, "one");
  bench.mustRun("segment pack.vdb one.vdb --tables small --unit um");
  bench.mustRun("measure one.vdb measured --unit um");
  CHECK(bench.bytes("small/bonds.csv") == bench.bytes("measured/bonds.csv"));
  CHECK(bench.run("segment pack.vdb one.vdb --unit um").err.find("give --tables, too") !=
        std::string::npos);
  bench.mustRun("generate spheres --size 40 --count 4 --radius 6:8 balls.vdb");
  const Outcome unknown = bench.run("segment balls.vdb none.vdb --tables none --unit um");
  CHECK(unknown.err.find("the voxel size is unknown") != std::string::npos);
}

TEST_CASE("cli: the tables of a CT scan, with two threads and with one", "[cli]") {
  const char* folder = std::getenv("VDB_MADF_DATA");
  const std::string scan = std::string(folder ? folder : VDB_MADF_DATA_DIR) + "/nmc.tif";
  if (!std::ifstream(scan)) {
    WARN("SKIPPED: no " << scan << ". Nothing was checked.");
    return;
  }
  const Bench bench;
  const std::string options = " grains.vdb --phase 1 --voxel-size 126nm --gamma 160 ";
  bench.mustRun("segment " + scan + options + "--tables two --threads 2");
  bench.mustRun("measure grains.vdb one --threads 1");
  for (const std::string file : {"grains.csv", "bonds.csv", "sample.json"})
    CHECK(bench.bytes("one/" + file) == bench.bytes("two/" + file));
  requireSumsFit(bench, "one");
}
