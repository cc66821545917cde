// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What each column and key of the files of vdb_madf measure says, on bricks.

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/csv_table.h"

using namespace vdb_madf::test;

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
