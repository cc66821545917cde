// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf measure, run as a user runs it: the three files, their units, and what fits together.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/program.h"

using namespace vdb_madf::test;
using Json = nlohmann::json;

namespace {

struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  explicit Table(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> cells;
      std::string cell;
      std::istringstream row(line + ",");
      while (std::getline(row, cell, ',')) cells.push_back(cell);
      if (names.empty())
        names = cells;
      else
        rows.push_back(cells);
    }
  }
  size_t column(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    INFO(name);
    REQUIRE(found != names.end());
    return size_t(found - names.begin());
  }
  double at(size_t row, const std::string& name) const {
    return std::stod(rows.at(row).at(column(name)));
  }
  double sum(const std::string& name) const {
    double sum = 0;
    for (size_t i = 0; i < rows.size(); ++i) sum += at(i, name);
    return sum;
  }
};

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

}  // namespace

TEST_CASE("cli: measure writes tables that fit together", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow --size 64 --length 14 --voxel-size 10um snow.vdb");
  bench.mustRun("segment snow.vdb grains.vdb");
  const std::string said = bench.mustRun("measure grains.vdb tables");
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
  CHECK(sample.at("ice_fraction").get<double>() == Approx(grains.sum("voxels") / (64.0 * 64 * 64)));
  CHECK(sample.at("density_kg_per_m3").get<double>() ==
        Approx(917 * sample.at("ice_fraction").get<double>()));
  CHECK(grains.sum("shared_area_mm2") == Approx(2 * bonds.sum("area_mm2")));
  CHECK(grains.sum("free_area_mm2") + grains.sum("shared_area_mm2") ==
        Approx(grains.sum("area_mm2")));
  CHECK(sample.at("specific_surface_per_mm").get<double>() ==
        Approx(grains.sum("free_area_mm2") / grains.sum("volume_mm3")));
  CHECK(sample.at("specific_surface_m2_per_kg").get<double>() ==
        Approx(1e3 * grains.sum("free_area_mm2") / grains.sum("volume_mm3") / 917));
  CHECK(grains.sum("cut_area_mm2") > 0);

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
}

TEST_CASE("cli: measure scales with the voxel size", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 60 --count 8 --radius 8:11 balls.vdb");
  const std::string said = bench.mustRun("measure balls.vdb voxels");  // the grid truth
  CHECK(said.find("voxel size          unknown") != std::string::npos);
  bench.mustRun("measure balls.vdb sized --voxel-size 20um --ice-density 900");
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

TEST_CASE("cli: measure refuses, and leaves nothing behind", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres --size 40 --count 4 --radius 6:8 balls.vdb");
  bench.write("file", "");
  const auto names = bench.names();
  CHECK(bench.run("measure balls.vdb").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --ice-density 0").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --ice-density ice").exitCode == 2);
  CHECK(bench.run("measure balls.vdb out --grid none").exitCode == 1);
  CHECK(bench.run("measure missing.vdb out").exitCode == 1);
  CHECK(bench.run("measure balls.vdb file").exitCode == 1);
  CHECK(bench.run("measure balls.vdb none/out").exitCode == 1);
  const Outcome outside = bench.run("measure balls.vdb out --domain 0,0,0:3,3,3");
  CHECK(outside.exitCode == 1);
  CHECK(outside.err.find("leaves the domain") != std::string::npos);
  CHECK(bench.names() == names);
}
