// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf collect, run as a user runs it.

#include <filesystem>
#include <map>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;

namespace {

using Row = std::map<std::string, std::string>;

/// The rows of a table by the names of its columns; cells may be in quotation marks.
std::vector<Row> rowsOf(const std::string& text) {
  std::vector<std::vector<std::string>> lines(1, std::vector<std::string>(1));
  bool inQuotes = false;
  for (const char c : text)
    if (c == '"')
      inQuotes = !inQuotes;
    else if (c == ',' && !inQuotes)
      lines.back().emplace_back();
    else if (c == '\n' && !inQuotes)
      lines.push_back({""});
    else
      lines.back().back() += c;
  std::vector<Row> rows;
  for (size_t i = 1; i + 1 < lines.size(); ++i) {
    REQUIRE(lines[i].size() == lines[0].size());
    rows.emplace_back();
    for (size_t k = 0; k < lines[0].size(); ++k) rows.back()[lines[0][k]] = lines[i][k];
  }
  return rows;
}

/// A folder with this sample.json.
void writeSample(const Bench& bench, const std::string& folder, const std::string& json) {
  std::filesystem::create_directory(bench.path(folder));
  bench.write(folder + "/sample.json", json);
}

}  // namespace

TEST_CASE("cli: collect writes a row a sample, with all its numbers", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow --size 40 --length 12 --voxel-size 10um snow.vdb");
  bench.mustRun("generate pack --size 40 --radius 5:8 --voxel-size 20um pack.vdb");
  bench.mustRun("segment snow.vdb a.vdb --gamma 20");
  bench.mustRun("segment pack.vdb b.vdb");
  bench.mustRun("measure a.vdb a --sample first --ice");
  bench.mustRun("measure b.vdb b --min-faces 5");
  const std::string said = bench.mustRun("collect a b out.csv");
  CHECK(said.find("out.csv: 2 samples") != std::string::npos);
  const std::vector<Row> rows = rowsOf(bench.bytes("out.csv"));
  REQUIRE(rows.size() == 2);
  for (size_t i = 0; i < 2; ++i) {
    const std::string folder = i == 0 ? "a" : "b";
    const Json sample = Json::parse(bench.bytes(folder + "/sample.json"));
    const Row& row = rows[i];
    CHECK(row.at("sample") == (i == 0 ? "first" : "b"));
    CHECK(row.at("folder") == folder);
    for (const auto& [key, value] : sample.items()) {  // nothing is lost but distributions, tensors
      CAPTURE(key);
      if (value.is_string())
        CHECK(row.at(key) == value.get<std::string>());
      else if (value.is_primitive())
        CHECK(row.at(key) == value.dump());
    }
    for (const auto& [key, value] : sample.at("segmentation").items()) {
      CAPTURE(key);
      CHECK(row.at("segmentation_" + key) ==
            (value.is_string() ? value.get<std::string>() : value.dump()));
    }
    CHECK(row.at("grain_diameter_by_volume_d50_mm") ==
          sample.at("grain_diameter_by_volume_mm").at("d50").dump());
    CHECK(row.at("correlation_length_z_mm") == sample.at("correlation_length_mm").at(2).dump());
    CHECK(row.at("box_max_x") == "39");
    CHECK(row.at("bond_normal_fabric_eigenvalue_1") ==
          sample.at("bond_normal_fabric").at("eigenvalues").at(0).dump());
    CHECK(row.count("coordination_distribution") == 0);
  }
  CHECK(rows[0].at("segmentation_gamma") == "20");
  // Only one sample was given a density: the other's cells are empty.
  CHECK(rows[0].at("solid_density_kg_per_m3") == "917.0");
  CHECK(rows[1].at("solid_density_kg_per_m3").empty());
  CHECK(rows[1].at("min_faces") == "5");
  // To standard output, the same.
  CHECK(bench.mustRun("collect a b -") == bench.bytes("out.csv"));
}

TEST_CASE("cli: collect names what it leaves out", "[cli]") {
  const Bench bench;
  writeSample(bench, "a", R"({"length_unit": "mm", "grains": 3})");
  std::filesystem::create_directory(bench.path("bare"));
  bench.write("file.csv", "");
  const Outcome some = bench.run("collect a bare file.csv a/ out.csv");
  CHECK(some.exitCode == 0);
  CHECK(some.err.find("bare: left out: holds no sample.json") != std::string::npos);
  CHECK(some.err.find("file.csv: left out: is no folder") != std::string::npos);
  CHECK(some.err.find("a: left out: is given twice") != std::string::npos);
  CHECK(rowsOf(bench.bytes("out.csv")).size() == 1);
  CHECK(bench.run("collect -q a bare quiet.csv").err.empty());
}

TEST_CASE("cli: collect replaces its own tables alone", "[cli]") {
  const Bench bench;
  writeSample(bench, "a", R"({"length_unit": "mm", "grains": 3})");
  bench.write("notes.csv", "day,snow\n1,wet\n");
  const Outcome outcome = bench.run("collect a notes.csv");
  CHECK(outcome.exitCode == 2);
  CHECK(outcome.err.find("notes.csv") != std::string::npos);
  CHECK(bench.bytes("notes.csv") == "day,snow\n1,wet\n");
  bench.mustRun("collect a out.csv");
  const std::string first = bench.bytes("out.csv");
  writeSample(bench, "a", R"({"length_unit": "mm", "grains": 4})");
  bench.mustRun("collect a out.csv");
  CHECK(bench.bytes("out.csv") != first);
}

TEST_CASE("cli: collect puts lengths into one unit", "[cli]") {
  const Bench bench;
  writeSample(bench, "small", R"({"length_unit": "um", "voxel_size_um": 0.5, "free_area_um2": 8,
    "specific_surface_per_um": 0.25, "object_volume_um3": 4e9, "grains": 3, "box_min": [1, 2, 3],
    "grain_diameter_by_number_um": {"d50": 6}, "correlation_length_um": [1, null, 2]})");
  writeSample(bench, "large", R"({"length_unit": "mm", "voxel_size_mm": 0.5, "free_area_mm2": 8})");
  writeSample(bench, "bare", R"({"length_unit": "voxel", "free_area_voxel2": 8})");
  bench.mustRun("collect small um.csv");
  CHECK(rowsOf(bench.bytes("um.csv")).at(0).at("free_area_um2") == "8");
  bench.mustRun("collect small large mm.csv");
  const std::vector<Row> rows = rowsOf(bench.bytes("mm.csv"));
  REQUIRE(rows.size() == 2);
  const Row& row = rows[0];
  for (const auto& [name, value] : row) {
    CAPTURE(name);
    CHECK(name.find("_um") == std::string::npos);
  }
  const auto number = [&](const char* name) { return std::stod(row.at(name)); };
  CHECK(row.at("length_unit") == "mm");
  CHECK(number("voxel_size_mm") == Approx(5e-4));
  CHECK(number("free_area_mm2") == Approx(8e-6));
  CHECK(number("specific_surface_per_mm") == Approx(250));
  CHECK(number("object_volume_mm3") == Approx(4));
  CHECK(number("grain_diameter_by_number_d50_mm") == Approx(6e-3));
  CHECK(number("correlation_length_z_mm") == Approx(2e-3));
  CHECK(row.at("correlation_length_y_mm").empty());
  CHECK(row.at("grains") == "3");
  CHECK(row.at("box_min_y") == "2");
  CHECK(rows[1].at("voxel_size_mm") == "0.5");
  writeSample(bench, "flat", R"({"length_unit": "um", "voxel_size_um": [0.5, 0.5, 1.5]})");
  bench.mustRun("collect flat large flat.csv");
  CHECK(std::stod(rowsOf(bench.bytes("flat.csv")).at(0).at("voxel_size_z_mm")) == Approx(1.5e-3));
  // Voxels have no length that would be known.
  const Outcome mixed = bench.run("collect large bare mixed.csv");
  CHECK(mixed.exitCode == 1);
  CHECK(mixed.err.find("large are in mm, those of bare in voxel") != std::string::npos);
  CHECK(mixed.err.find("--voxel-size") != std::string::npos);
  CHECK(bench.names().count("mixed.csv") == 0);
}

TEST_CASE("cli: collect writes texts as cells", "[cli]") {
  const Bench bench;
  writeSample(bench, "a", R"({"length_unit": "mm", "labels": "core 3, \"wet\"\nlower"})");
  bench.mustRun("collect a out.csv");
  CHECK(bench.bytes("out.csv") ==
        "sample,folder,length_unit,labels\na,a,mm,\"core 3, \"\"wet\"\"\nlower\"\n");
}

TEST_CASE("cli: collect refuses what measure does not write, and leaves nothing behind", "[cli]") {
  const Bench bench;
  writeSample(bench, "good", R"({"length_unit": "mm"})");
  int number = 0;
  for (const char* text : {"", "{", "[1]", "7", "{}", R"({"length_unit": "inch"})",
                           R"({"length_unit": 3})", "\xff\xfe"}) {
    const std::string folder = "bad" + std::to_string(number++);
    writeSample(bench, folder, text);
    const Outcome outcome = bench.run("collect good " + folder + " out.csv");
    CAPTURE(text);
    CHECK(outcome.exitCode == 1);
    CHECK(outcome.err.find(folder + "/sample.json") != std::string::npos);
    CHECK(outcome.err.find("vdb_madf measure") != std::string::npos);
  }
  writeSample(bench, "deep",
              "{\"length_unit\": \"mm\", \"a\": " + std::string(200000, '[') +
                  std::string(200000, ']') + "}");
  CHECK(bench.run("collect deep deep.csv").exitCode == 0);
  std::filesystem::create_directory(bench.path("bare"));
  CHECK(bench.run("collect bare out.csv").exitCode == 1);
  CHECK(bench.run("collect missing good out.csv").exitCode == 1);
  CHECK(bench.run("collect good none/out.csv").exitCode == 1);
  std::filesystem::create_directories(bench.path("folder/sample.json"));
  CHECK(bench.run("collect good folder out.csv").exitCode == 1);
  CHECK(bench.names().count("out.csv") == 0);
}
