// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf measure, run as a user runs it: the three files, their units, and what fits together.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/csv_table.h"
#include "support/refusals.h"

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

TEST_CASE("cli: measure says what each column says, to the digit", "[cli]") {
  // Two bricks with a face in common, and a small one in a corner of the domain; voxels of 20 um.
  const Bench bench;
  constexpr int kX = 40, kY = 30, kZ = 25;
  std::string raw(size_t(kX * kY * kZ), '\0');
  const auto brick = [&](int x0, int y0, int z0, int nx, int ny, int nz, char label) {
    for (int z = z0; z < z0 + nz; ++z)
      for (int y = y0; y < y0 + ny; ++y)
        for (int x = x0; x < x0 + nx; ++x) raw[size_t((z * kY + y) * kX + x)] = label;
  };
  brick(3, 5, 7, 20, 12, 8, 3);
  brick(23, 5, 7, 6, 12, 8, 5);
  brick(0, 0, 0, 4, 3, 5, 9);
  bench.write("bricks.raw", raw);
  bench.mustRun(
      "measure bricks.raw out --dims 40x30x25 --type uint8 --voxel-size 20um --density 2650");
  constexpr double e = 0.02;

  using Row = std::map<std::string, double>;
  const auto check = [](const Table& table, size_t row, const Row& expected) {
    REQUIRE(table.names.size() == expected.size());
    for (const auto& [name, value] : expected) {
      CAPTURE(name, row);
      CHECK(table.at(row, name) == Approx(value).epsilon(1e-8).margin(1e-9));
    }
  };
  const Table grains(bench.bytes("out/grains.csv")), bonds(bench.bytes("out/bonds.csv"));
  REQUIRE(grains.rows.size() == 3);
  const auto ballDiameter = [](double voxels) { return std::cbrt(6 * voxels / M_PI); };
  // Edges ordered by length; corner and edges in voxels.
  const auto grain = [&](size_t row, double id, std::array<double, 3> corner,
                         std::array<double, 3> edges, std::array<size_t, 3> order,
                         std::array<double, 3> deepest, double radius, double shared, double cut,
                         double bondCount, double atFace) {
    const double voxels = edges[0] * edges[1] * edges[2], d = ballDiameter(voxels);
    const double free = grains.at(row, "free_area_mm2") / (e * e);
    const double faces = 2 * (edges[0] * edges[1] + edges[1] * edges[2] + edges[2] * edges[0]);
    CHECK(free == Approx(faces - shared - cut).epsilon(0.12));  // edges are rounded off
    Row want = {{"id", id},
                {"voxels", voxels},
                {"volume_mm3", voxels * e * e * e},
                {"equivalent_diameter_mm", d * e},
                {"inscribed_radius_mm", radius * e},
                {"area_mm2", (free + shared) * e * e},
                {"free_area_mm2", free * e * e},
                {"shared_area_mm2", shared * e * e},
                {"cut_area_mm2", cut * e * e},
                {"sphericity", M_PI * d * d / (free + shared + cut)},
                {"aspect_2_to_1", edges[order[1]] / edges[order[0]]},
                {"aspect_3_to_2", edges[order[2]] / edges[order[1]]},
                {"coordination", bondCount},
                {"at_domain_face", atFace}};
    for (size_t i = 0; i < 3; ++i) {
      const std::string axis(1, "xyz"[i]), which = "axis" + std::to_string(i + 1);
      want["centroid_" + axis + "_mm"] = (corner[i] + (edges[i] - 1) / 2) * e;
      want["representative_" + axis + "_mm"] = deepest[i] * e;
      want["box_min_" + axis] = corner[i];
      want["box_max_" + axis] = corner[i] + edges[i] - 1;
      want[which + "_length_mm"] = edges[order[i]] * std::sqrt(5.0 / 3) * e;
      for (size_t k = 0; k < 3; ++k)
        want[which + "_" + std::string(1, "xyz"[k])] = order[i] == k ? 1 : 0;
    }
    check(grains, row, want);
    return free;
  };
  double free = grain(0, 3, {3, 5, 7}, {20, 12, 8}, {0, 1, 2}, {6, 8, 10}, 4, 96, 0, 1, 0);
  free += grain(1, 5, {23, 5, 7}, {6, 12, 8}, {1, 2, 0}, {23, 8, 10}, 4, 96, 0, 1, 0);
  // Seen on past the faces of the domain, the corner is the deepest place.
  free += grain(2, 9, {0, 0, 0}, {4, 3, 5}, {2, 0, 1}, {0, 0, 0}, 3, 0, 12 + 15 + 20, 0, 1);

  REQUIRE(bonds.rows.size() == 1);
  check(bonds, 0,
        {{"first", 3},
         {"second", 5},
         {"faces", 96},
         {"area_mm2", 96 * e * e},
         {"radius_mm", std::sqrt(96 / M_PI) * e},
         {"centroid_x_mm", 22.5 * e},
         {"centroid_y_mm", 10.5 * e},
         {"centroid_z_mm", 10.5 * e},
         {"normal_x", 1},
         {"normal_y", 0},
         {"normal_z", 0},
         {"distance_mm", 17 * e},
         {"cos_alpha", (17.0 * 17 - 16 - 16) / (2 * 16)},
         {"flatness_mm2", 0},
         {"patches", 1},
         {"curvature_points", 32},
         {"mean_curvature_per_mm", 0},
         {"mean_curvature_sd_per_mm", 0},
         {"gaussian_curvature_per_mm2", 0},
         {"gaussian_curvature_sd_per_mm2", 0},
         {"curvature_residual_mm", 0}});

  const Json sample = Json::parse(bench.bytes("out/sample.json"));
  const double voxels = 1920 + 576 + 60, fraction = voxels / (kX * kY * kZ);
  const auto number = [&](const char* key) { return sample.at(key).get<double>(); };
  CHECK(sample.at("version").is_string());
  CHECK(sample.at("labels") == "bricks.raw");
  CHECK(sample.at("labels_digest").get<std::string>().size() == 32);
  CHECK(sample.at("segmentation") == Json({{"source", "bricks.raw"}}));
  CHECK(sample.at("boundary") == "open");
  CHECK(sample.at("length_unit") == "mm");
  CHECK(number("voxel_size_mm") == Approx(e));
  CHECK(sample.at("box") == "domain");
  CHECK(sample.at("box_min") == Json({0, 0, 0}));
  CHECK(sample.at("box_max") == Json({kX - 1, kY - 1, kZ - 1}));
  CHECK(sample.at("grains") == 3);
  CHECK(sample.at("bonds") == 1);
  CHECK(sample.at("bonds_without_curvature") == 0);
  CHECK(sample.at("min_faces") == 1);
  CHECK(sample.at("contacts_left_out") == 0);
  CHECK(sample.at("contacts_left_out_area_mm2") == 0);
  CHECK(number("object_voxels") == voxels);
  CHECK(number("object_volume_mm3") == Approx(voxels * e * e * e));
  CHECK(number("solid_fraction") == Approx(fraction));
  CHECK(number("solid_density_kg_per_m3") == 2650);
  CHECK(number("bulk_density_kg_per_m3") == Approx(2650 * fraction));
  CHECK(number("free_area_mm2") == Approx(free * e * e));
  CHECK(number("shared_area_mm2") == Approx(96 * e * e));
  CHECK(number("specific_surface_per_mm") == Approx(free / voxels / e));
  CHECK(number("specific_surface_m2_per_kg") == Approx(free / voxels / (e * 1e-3) / 2650));
  CHECK(sample.at("area_estimator").is_string());
  CHECK(sample.at("euler_characteristic") == 2);
  CHECK(sample.at("components") == 2);
  CHECK(number("mean_coordination") == Approx(2.0 / 3));
  CHECK(sample.at("coordination_distribution") == Json({1, 2}));
  CHECK(number("bond_to_grain_ratio") == Approx(2 * std::sqrt(96 / M_PI) / ballDiameter(576)));
  const double small = ballDiameter(60) * e, middle = ballDiameter(576) * e,
               large = ballDiameter(1920) * e;
  const Row byNumber = {{"d5", small},  {"d10", small}, {"d25", small}, {"d50", middle},
                        {"d75", large}, {"d90", large}, {"d95", large}},
            byVolume = {{"d5", middle}, {"d10", middle}, {"d25", large}, {"d50", large},
                        {"d75", large}, {"d90", large},  {"d95", large}};
  for (const auto& [key, sizes] : {std::pair("grain_diameter_by_number_mm", byNumber),
                                   std::pair("grain_diameter_by_volume_mm", byVolume)}) {
    REQUIRE(sample.at(key).size() == sizes.size());
    for (const auto& [percentile, size] : sizes) {
      CAPTURE(key, percentile);
      CHECK(sample.at(key).at(percentile).get<double>() == Approx(size));
    }
  }
  // Longest axes x, y and z; they are eigenvectors already, in the order of the grains' volumes.
  const Json& fabric = sample.at("grain_axis_fabric");
  const double weights[] = {1920 / voxels, 576 / voxels, 60 / voxels};
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k) {
      CHECK(fabric.at("tensor").at(i).at(k).get<double>() ==
            Approx(i == k ? weights[i] : 0).margin(1e-12));
      CHECK(fabric.at("eigenvectors").at(i).at(k).get<double>() ==
            Approx(i == k ? 1 : 0).margin(1e-12));
    }
  for (size_t i = 0; i < 3; ++i)
    CHECK(fabric.at("eigenvalues").at(i).get<double>() == Approx(weights[i]));
  CHECK(sample.at("correlation_length_mm").size() == 3);
  const Json& biases = sample.at("expected_bias_percent");  // of median radii of 8 and 4 voxels
  CHECK(biases.size() >= 2);
  CHECK(biases.at("specific_surface").get<double>() == Approx(-7).margin(1));
  CHECK(biases.at("mean_coordination").get<double>() == Approx(17).margin(2));
  CHECK(sample.size() == 37);  // no key that is not looked at
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

TEST_CASE("cli: the tables of a CT scan, with one thread and with two", "[cli]") {
  const char* folder = std::getenv("VDB_MADF_DATA");
  const std::string scan = std::string(folder ? folder : VDB_MADF_DATA_DIR) + "/nmc.tif";
  if (!std::ifstream(scan)) {
    WARN("SKIPPED: no " << scan << ". Nothing was checked.");
    return;
  }
  const Bench bench;
  const std::string options = " grains.vdb --phase 1 --voxel-size 126nm --gamma 160 ";
  bench.mustRun("segment " + scan + options + "--tables one --threads 1");
  bench.mustRun("segment " + scan + options + "--tables two --threads 2");
  bench.mustRun("measure grains.vdb measured --threads 1");
  for (const std::string file : {"grains.csv", "bonds.csv", "sample.json"}) {
    CHECK(bench.bytes("one/" + file) == bench.bytes("two/" + file));
    CHECK(bench.bytes("one/" + file) == bench.bytes("measured/" + file));
  }
  requireSumsFit(bench, "one");
}
