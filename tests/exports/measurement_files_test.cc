// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/measurement_files.h"

#include <openvdb/Metadata.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#ifdef VDB_MADF_HDF5
#include "support/hdf5_files.h"
#endif

#include "support/catch.h"
#include "support/files.h"
#include "support/full_disk.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/version.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/measure/columns.h"

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

TEST_CASE("measurement_files: lengths are in the unit that is asked for", "[measurement_files]") {
  Measurements m = fewMeasurements();
  TableOptions options;
  options.unit = "um";
  CHECK_THROWS_AS(measurementTexts(m, options), InvalidInput);  // the voxel size is unknown
  m.voxelSize = VoxelSize{0.5e-6};
  const MeasurementTexts inMm = measurementTexts(m), inUm = measurementTexts(m, options);
  CHECK(cell(inMm.grains, 0, "equivalent_diameter_mm") == "0.000333333333");
  CHECK(cell(inUm.grains, 0, "equivalent_diameter_um") == "0.333333333");
  CHECK(cell(inUm.grains, 0, "free_area_um2") == "1.5");
  CHECK(cell(inUm.bonds, 0, "mean_curvature_per_um") == "6");
  const auto sample = nlohmann::json::parse(inUm.sample);
  CHECK(sample.at("length_unit") == "um");
  CHECK(sample.at("voxel_size_um") == 0.5);
  CHECK(sample.at("object_volume_um3") == 1);
  options.unit = "mm";
  CHECK(measurementTexts(m, options).grains == inMm.grains);
  CHECK(measurementTexts(m, options).sample == inMm.sample);
  options.unit = "km";
  CHECK_THROWS_AS(measurementTexts(m, options), InvalidInput);
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

#ifndef VDB_MADF_HDF5

TEST_CASE("measurement_files: a build without HDF5 says so before the work",
          "[measurement_files]") {
  WARN("SKIPPED: tables in HDF5: built without libhdf5-dev");
  const ScratchFolder scratch;
  CHECK_THROWS_WITH(MeasurementTables(scratch / "t.h5"), vdb_madf::test::Contains("libhdf5"));
  CHECK(scratch.fileCount() == 0);
}

#else

namespace {

/// All numbers of a dataset, which are of the kind of T.
template <typename T>
std::vector<T> hdf5Values(hid_t file, const std::string& name) {
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  REQUIRE(dataset >= 0);
  const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
  CHECK(H5Tget_class(type) == (std::is_integral_v<T> ? H5T_INTEGER : H5T_FLOAT));
  std::vector<T> values(size_t(H5Sget_simple_extent_npoints(space)));
  H5Dread(dataset, std::is_integral_v<T> ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL,
          H5P_DEFAULT, values.data());
  H5Tclose(type);
  H5Sclose(space);
  H5Dclose(dataset);
  return values;
}

/// Of a dataset; "" if there is none.
std::string unitsOf(hid_t file, const std::string& name) {
  if (H5Aexists_by_name(file, name.c_str(), "units", H5P_DEFAULT) <= 0) return "";
  const hid_t attribute = H5Aopen_by_name(file, name.c_str(), "units", H5P_DEFAULT, H5P_DEFAULT);
  const hid_t type = H5Aget_type(attribute);
  std::string text(H5Tget_size(type), ' ');
  H5Aread(attribute, type, text.data());
  H5Tclose(type);
  H5Aclose(attribute);
  return text;
}

}  // namespace

TEST_CASE("measurement_files: HDF5 has every column with all its digits and its unit",
          "[measurement_files]") {
  const ScratchFolder scratch;
  const auto grid = labelGrid(randomLabels(3, {5, 6, 7}, 14, 20, 70));
  const auto edges = GENERATE(std::array<double, 3>{8.5e-6, 8.5e-6, 8.5e-6},
                              std::array<double, 3>{9e-6, 8e-6, 7e-6});
  setVoxelSize(*grid, VoxelSize(edges));
  const Measurements m = measure(*grid);
  REQUIRE(m.bonds.size() > 10);
  MeasurementTables(scratch / "t.h5").write(m);
  CHECK(scratch.fileCount() == 1);
  const openvdb::Vec3d lengths(edges[0] * 1e3, edges[1] * 1e3, edges[2] * 1e3);
  const hid_t file = H5Fopen((scratch / "t.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const std::map<int, std::string> units = {{-2, "1/mm^2"}, {-1, "1/mm"}, {0, ""},
                                            {1, "mm"},      {2, "mm^2"},  {3, "mm^3"}};
  for (const std::string table : {"grains", "bonds"})
    for (const MeasureColumn& column :
         table == "grains" ? grainColumns(m.grains) : bondColumns(m.bonds)) {
      const std::string name = table + "/" + column.name;
      CAPTURE(name);
      CHECK(unitsOf(file, name) == units.at(column.power));
      if (column.isWhole()) {
        CHECK(hdf5Values<int64_t>(file, name) ==
              std::vector<int64_t>(column.values.begin(), column.values.end()));
        continue;
      }
      const auto values = hdf5Values<double>(file, name);
      REQUIRE(values.size() == column.values.size());
      for (size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(column.values[i]))
          CHECK(std::isnan(values[i]));
        else
          CHECK(values[i] == Approx(scaled(column, column.values[i], lengths)).epsilon(1e-14));
      }
    }
  CHECK(hdf5Values<int64_t>(file, "sample/grains") ==
        std::vector<int64_t>{int64_t(m.grains.size())});
  CHECK(hdf5Values<double>(file, "sample/solid_fraction") ==
        std::vector<double>{m.sample.objectFraction});
  CHECK(hdf5Values<double>(file, "sample/grain_axis_fabric/tensor").size() == 9);
  H5Fclose(file);
}

TEST_CASE("measurement_files: HDF5 has lists, unknown numbers and any name of the metadata",
          "[measurement_files]") {
  const ScratchFolder scratch;
  Measurements m = fewMeasurements();
  constexpr int64_t kLarge = (int64_t(1) << 62) + 1;  // no double
  m.metadata.insertMeta("madf_a/b", openvdb::Int64Metadata(kLarge));
  m.metadata.insertMeta("madf_", openvdb::StringMetadata(""));
  m.metadata.insertMeta("madf_yes", openvdb::BoolMetadata(true));
  MeasurementTables(scratch / "t.hdf5").write(m, {"", "core \xff", std::nullopt});
  const hid_t file = H5Fopen((scratch / "t.hdf5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  CHECK(hdf5Values<int64_t>(file, "grains/voxels") == std::vector<int64_t>{12345678901});
  const auto lengths = hdf5Values<double>(file, "sample/correlation_length_voxel");
  REQUIRE(lengths.size() == 3);
  CHECK((lengths[0] == 1.5 && std::isnan(lengths[1]) && lengths[2] == 2));
  CHECK(hdf5Values<int64_t>(file, "sample/segmentation/a_b") == std::vector<int64_t>{kLarge});
  CHECK(H5Lexists(file, "sample/segmentation/_", H5P_DEFAULT) > 0);
  CHECK(hdf5Values<int64_t>(file, "sample/segmentation/yes") == std::vector<int64_t>{1});
  CHECK(unitsOf(file, "grains/volume") == "voxel^3");
  H5Fclose(file);

  MeasurementTables(scratch / "none.h5").write(Measurements());
  const hid_t none = H5Fopen((scratch / "none.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  CHECK(hdf5Values<int64_t>(none, "grains/id").empty());
  CHECK(hdf5Values<double>(none, "bonds/area").empty());
  H5Fclose(none);
}

TEST_CASE("measurement_files: HDF5 is written whole or not at all, and the same again",
          "[measurement_files]") {
  const ScratchFolder scratch;
  const Measurements m = fewMeasurements();
  { const MeasurementTables notWritten(scratch / "t.h5"); }
  CHECK(scratch.fileCount() == 0);
  CHECK(MeasurementTables::paths("a/t.H5") == std::vector<std::string>{"a/t.H5"});
  CHECK_THROWS_AS(MeasurementTables(scratch / "none/t.h5"), IoError);
  MeasurementTables(scratch / "t.h5").write(m);
  const std::string bytes = readFile(scratch / "t.h5");
  {
    MeasurementTables tables(scratch / "t.h5");
    const FullDisk disk(bytes.size() / 2);
    CHECK_THROWS_AS(tables.write(m), IoError);
  }
  CHECK(scratch.fileCount() == 1);
  CHECK(readFile(scratch / "t.h5") == bytes);
  MeasurementTables(scratch / "t.h5").write(m);
  CHECK(readFile(scratch / "t.h5") == bytes);
}

#endif
