// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/measurement_files.h"

#include <openvdb/Metadata.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/files.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// A grain and a bond of which only this is known.
Measurements fewMeasurements() {
  Measurements m;
  GrainMeasures grain;
  grain.id = 7;
  grain.voxels = 12345678901;  // more than nine digits
  grain.volume = double(grain.voxels);
  grain.equivalentDiameter = 2.0 / 3;
  grain.freeArea = 6;
  grain.ellipsoid.values = {4, 2, 1};
  m.grains = {grain};
  BondMeasures bond;
  bond.first = 7;
  bond.second = 9;
  bond.normal = {-0.0, 0, 1};
  bond.curvature = InterfaceCurvature{1, 3, 0, 1, 0, 2};
  m.bonds = {bond, BondMeasures()};
  m.sample.objectVoxels = 8;
  m.sample.objectVolume = 8;
  m.sample.objectFraction = 0.5;
  m.sample.specificSurface = 3;
  m.sample.correlationLengths = {1.5, std::nullopt, 2.0};
  return m;
}

/// The cell of a table by the name of its column.
std::string cell(const std::string& text, size_t row, const std::string& name) {
  std::vector<std::vector<std::string>> lines(1, std::vector<std::string>(1));
  for (const char c : text)
    if (c == '\n')
      lines.push_back({""});
    else if (c == ',')
      lines.back().push_back("");
    else
      lines.back().back() += c;
  for (size_t i = 0; i < lines[0].size(); ++i)
    if (lines[0][i] == name) return lines.at(row + 1).at(i);
  throw std::runtime_error("no column " + name);
}

}  // namespace

TEST_CASE("measurement_files: units and digits of the tables", "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  MeasurementTables(scratch / "voxels").write(m);
  m.voxelSize = VoxelSize{0.5e-3};
  MeasurementTables(scratch / "mm").write(m);
  const std::string inVoxels = readFile(scratch / "voxels/grains.csv"),
                    inMm = readFile(scratch / "mm/grains.csv");
  CHECK(cell(inVoxels, 0, "id") == "7");
  CHECK(cell(inVoxels, 0, "voxels") == "12345678901");
  CHECK(cell(inVoxels, 0, "equivalent_diameter_voxel") == "0.666666667");
  CHECK(cell(inMm, 0, "equivalent_diameter_mm") == "0.333333333");
  CHECK(cell(inMm, 0, "free_area_mm2") == "1.5");
  CHECK(cell(inMm, 0, "aspect_2_to_1") == "0.5");
  CHECK(cell(inMm, 0, "inscribed_radius_mm").empty());
  CHECK(cell(inMm, 0, "representative_x_mm").empty());
  CHECK(cell(inMm, 0, "at_domain_face") == "0");
  const std::string bonds = readFile(scratch / "mm/bonds.csv");
  CHECK(cell(bonds, 0, "normal_x") == "0");  // not -0
  CHECK(cell(bonds, 0, "mean_curvature_per_mm") == "6");
  CHECK(cell(bonds, 0, "gaussian_curvature_per_mm2") == "4");
  CHECK(cell(bonds, 0, "curvature_residual_mm") == "1");
  CHECK(cell(bonds, 1, "curvature_points") == "0");
  CHECK(cell(bonds, 1, "mean_curvature_per_mm").empty());
  CHECK(cell(bonds, 1, "cos_alpha").empty());
}

TEST_CASE("measurement_files: the sample", "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  m.voxelSize = VoxelSize{0.5e-3};
  MeasurementTables(scratch / "t").write(m, {"", "", 900});
  const auto sample = nlohmann::json::parse(readFile(scratch / "t/sample.json"));
  CHECK(sample.at("length_unit") == "mm");
  CHECK(sample.at("object_volume_mm3") == 1);
  CHECK(sample.at("solid_fraction") == 0.5);
  CHECK(sample.at("solid_density_kg_per_m3") == 900);
  CHECK(sample.at("bulk_density_kg_per_m3") == 450);
  CHECK(sample.at("specific_surface_per_mm") == 6);
  CHECK(sample.at("specific_surface_m2_per_kg").get<double>() == Approx(6000 / 900.0));
  CHECK(sample.at("correlation_length_mm") == nlohmann::json({0.75, nullptr, 1.0}));
  CHECK(sample.at("bond_to_grain_ratio").is_null());
}

TEST_CASE("measurement_files: no word of a mass without a density", "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  m.voxelSize = VoxelSize{0.5e-3};
  MeasurementTables(scratch / "t").write(m);
  const std::string text = readFile(scratch / "t/sample.json");
  CHECK(nlohmann::json::parse(text).at("solid_fraction") == 0.5);
  CHECK(text.find("kg") == std::string::npos);
  CHECK(text.find("ice_") == std::string::npos);
}

TEST_CASE("measurement_files: where the numbers come from", "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  m.gridName = "grain";
  m.labelDigest = "0123";
  m.open = true;
  m.metadata.insertMeta("madf_theta", openvdb::DoubleMetadata(-0.9));
  m.metadata.insertMeta("madf_gamma", openvdb::Int64Metadata(20));
  m.metadata.insertMeta("madf_source", openvdb::StringMetadata("scan \xff.tif"));
  m.metadata.insertMeta("madf_voxel_size_m", openvdb::DoubleMetadata(1));
  m.metadata.insertMeta("file_bbox_min", openvdb::Int32Metadata(3));
  m.metadata.insertMeta("madf_domain_min", openvdb::Vec3IMetadata(openvdb::Vec3i(1)));
  MeasurementTables(scratch / "t").write(m, {"a/grains.vdb", "", std::nullopt});
  const auto sample = nlohmann::json::parse(readFile(scratch / "t/sample.json"));
  CHECK(sample.at("labels") == "a/grains.vdb");
  CHECK(sample.at("grid") == "grain");
  CHECK(sample.at("labels_digest") == "0123");
  CHECK(sample.at("boundary") == "open");
  CHECK(sample.at("version") == kVersion);
  CHECK_FALSE(sample.contains("sample"));
  CHECK(sample.at("segmentation") ==
        nlohmann::json({{"theta", -0.9}, {"gamma", 20}, {"source", "scan \xef\xbf\xbd.tif"}}));
}

TEST_CASE("measurement_files: what fractions refer to", "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  const auto sample = [&] {
    MeasurementTables(scratch / "t").write(m);
    return nlohmann::json::parse(readFile(scratch / "t/sample.json"));
  };
  m.sample.domainKnown = false;
  CHECK(sample().at("box") == "grains");
  m.sample.domainKnown = true;
  CHECK(sample().at("box") == "domain");
  CHECK_FALSE(sample().contains("domain_voxels"));
  m.sample.regionVoxels = 6000000000;
  CHECK(sample().at("box") == "region");
  CHECK(sample().at("domain_voxels") == 6000000000);
}

TEST_CASE("measurement_files: a named sample stands in every row", "[measurement_files]") {
  const ScratchFolder scratch;
  const Measurements m = fewMeasurements();
  MeasurementTables(scratch / "plain").write(m);
  MeasurementTables(scratch / "named").write(m, {"", "core 3, \"wet\"", std::nullopt});
  CHECK(nlohmann::json::parse(readFile(scratch / "named/sample.json")).at("sample") ==
        "core 3, \"wet\"");
  // The tables are the same but for the first column.
  for (const std::string table : {"grains.csv", "bonds.csv"}) {
    std::string named = readFile(scratch / ("named/" + table));
    CHECK(named.compare(0, 7, "sample,") == 0);
    named.erase(0, 7);
    const std::string cell = "\n\"core 3, \"\"wet\"\"\",";
    for (size_t at = named.find(cell); at != std::string::npos; at = named.find(cell))
      named.erase(at + 1, cell.size() - 1);
    CHECK(named == readFile(scratch / ("plain/" + table)));
  }
}

TEST_CASE("measurement_files: whole or not at all", "[measurement_files]") {
  const ScratchFolder scratch;
  CHECK(MeasurementTables::paths("a/b")[2] == "a/b/sample.json");
  { const MeasurementTables notWritten(scratch / "t"); }
  CHECK_FALSE(std::filesystem::exists(scratch / "t"));
  CHECK_THROWS_AS(MeasurementTables(scratch / "none/t"), IoError);
  writeFile(scratch / "file", "");
  CHECK_THROWS_AS(MeasurementTables(scratch / "file"), IoError);
  // One of the three cannot be written: none appears, and a folder that was there stays.
  std::filesystem::create_directories(scratch / "t/bonds.csv");
  CHECK_THROWS_AS(MeasurementTables(scratch / "t"), IoError);
  CHECK(std::filesystem::is_directory(scratch / "t/bonds.csv"));
  CHECK_FALSE(std::filesystem::exists(scratch / "t/grains.csv"));
}

TEST_CASE("measurement_files: unequal voxels have three edges, and their shortest is the unit",
          "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  m.edges = openvdb::Vec3d(2, 1, 3);
  m.grains[0].centroid = openvdb::Vec3d(10, 20, 30);
  const auto places = [&](const std::string& unit) {
    const std::string text = readFile(scratch / "t/grains.csv");
    std::vector<std::string> cells;
    for (const std::string name : {"centroid_x", "centroid_y", "centroid_z", "free_area"})
      cells.push_back(cell(text, 0, name + "_" + unit + (name == "free_area" ? "2" : "")));
    return cells;
  };
  MeasurementTables(scratch / "t").write(m);
  CHECK(places("voxel") == std::vector<std::string>{"20", "20", "90", "6"});
  m.voxelSize = VoxelSize(std::array<double, 3>{0.5e-3, 0.25e-3, 0.75e-3});
  TableOptions options;
  options.density = 1000;
  MeasurementTables(scratch / "t").write(m, options);
  CHECK(places("mm") == std::vector<std::string>{"5", "5", "22.5", "0.375"});
  const auto sample = nlohmann::json::parse(readFile(scratch / "t/sample.json"));
  CHECK(sample.at("voxel_size_mm") == std::vector<double>{0.5, 0.25, 0.75});
  CHECK(sample.at("specific_surface_per_mm") == 12);
  CHECK(sample.at("specific_surface_m2_per_kg").get<double>() == Approx(12));
  CHECK(sample.at("correlation_length_mm").at(0) == 0.375);
  CHECK(sample.at("object_volume_mm3") == 0.125);
}
