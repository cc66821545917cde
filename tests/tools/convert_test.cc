// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf convert, run as a user runs it: formats, types, selections, labels, voxel sizes.

#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;

namespace {

/// Sample values 0..7 in a row of eight.
std::string ramp() {
  return {"\0\1\2\3\4\5\6\7", 8};
}

/// "00010000" of the bytes 0, 0, 0, 1 ...
std::string digits(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) text += char('0' + c);
  return text;
}

}  // namespace

TEST_CASE("cli: convert keeps every sample through every format", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.raw --dims 30x20x10 --length 8");
  const std::string samples = bench.bytes("s.raw");
  REQUIRE(samples.size() == 30 * 20 * 10);
  std::string from = "s.raw";
  std::string layout = " --dims 30x20x10 --type uint8";
  for (const std::string to :
       {"a.tif", "a.mhd", "a.mha", "a.nrrd", "a.npy", "a.vdb", "b.tif", "b.vdb", "b.raw"}) {
    bench.mustRun("convert " + from + " " + to + layout);
    from = to;
    layout = "";
  }
  CHECK(bench.bytes("b.raw") == samples);
  CHECK(gridsOf(infoOf(bench, "a.vdb")) == std::set<std::string>{"object"});
}

TEST_CASE("cli: convert changes the sample type", "[cli]") {
  const Bench bench;
  bench.write("ramp.raw", ramp());
  bench.mustRun("convert ramp.raw f.raw --dims 8x1x1 --type uint8 --out-type float32");
  float values[8];
  REQUIRE(bench.bytes("f.raw").size() == sizeof values);
  std::memcpy(values, bench.bytes("f.raw").data(), sizeof values);
  for (int i = 0; i < 8; ++i) CHECK(values[i] == float(i));

  bench.mustRun("convert ramp.raw r.tif --dims 8x1x1 --type uint8");
  bench.mustRun("convert r.tif u.raw --type uint16");  // of the output, as the input is not RAW
  CHECK(bench.bytes("u.raw").size() == 16);
  bench.mustRun("convert ramp.raw big.raw --dims 4x1x1 --type uint16 --big-endian");
  CHECK(bench.bytes("big.raw") == std::string("\1\0\3\2\5\4\7\6", 8));
}

TEST_CASE("cli: a dataset is chosen by its name", "[cli]") {
  const Bench bench;
  for (const std::string name : {"a", "b"}) {
    std::filesystem::create_directories(bench.path("z.zarr/" + name));
    bench.write("z.zarr/" + name + "/.zarray",
                R"({"zarr_format": 2, "shape": [1, 1, 8], "chunks": [1, 1, 8], "dtype": "|u1",
                    "compressor": null, "fill_value": 0, "filters": null, "order": "C"})");
    bench.write("z.zarr/" + name + "/0.0.0",
                name == "a" ? ramp() : std::string("\0\7\7\7\7\7\7\7", 8));
  }
  bench.write("z.zarr/.zgroup", R"({"zarr_format": 2})");
  const Outcome several = bench.run("info z.zarr");
  CHECK(several.exitCode == 1);
  CHECK(several.err.find("'a', 'b'") != std::string::npos);
  bench.mustRun("convert z.zarr a.raw --dataset a");
  CHECK(bench.bytes("a.raw") == ramp());
  bench.mustRun("segment z.zarr b.vdb --dataset b");
  CHECK(gridOf(infoOf(bench, "b.vdb"), "grain").at("active_voxels") == 7);
}

TEST_CASE("cli: the selection says what is object", "[cli]") {
  const Bench bench;
  bench.write("ramp.raw", ramp());
  bench.mustRun("convert ramp.raw ramp.tif --dims 8x1x1 --type uint8");
  const std::pair<const char*, const char*> cases[] = {
      {"--phase 3", "00010000"},           {"--threshold 5", "00000111"},
      {"--range 2:4", "00111000"},         {"--threshold 1 --invert", "10000000"},
      {"--phase 3 --invert", "11101111"},  {"--threshold 5 --invert", "11111000"},
      {"--range 2:4 --invert", "11000111"}};
  for (const auto& [selection, object] : cases) {
    CAPTURE(selection);
    bench.mustRun(std::string("convert ramp.tif o.raw ") + selection);
    CHECK(digits(bench.bytes("o.raw")) == object);
    bench.mustRun(std::string("convert ramp.tif o.vdb ") + selection);
    bench.mustRun("convert o.vdb o.raw");
    CHECK(digits(bench.bytes("o.raw")) == object);
  }
}

TEST_CASE("cli: the voxel size goes from the option through every file", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow a.mhd --size 16 --length 6 --voxel-size 8.5um");
  bench.mustRun("convert a.mhd b.vdb");
  bench.mustRun("convert b.vdb c.tif");
  bench.mustRun("convert c.tif d.vdb");
  bench.mustRun("segment d.vdb e.vdb --json e.json");
  for (const std::string file : {"a.mhd", "c.tif"})
    CHECK(infoOf(bench, file).at("voxel_size_mm").get<double>() == Approx(0.0085));
  for (const std::string file : {"b.vdb", "d.vdb", "e.vdb"}) {
    const Json grid = infoOf(bench, file).at("grids").at(0);
    CHECK(grid.at("voxel_size_mm").get<double>() == Approx(0.0085));
    CHECK(grid.at("voxel_size_units").at(0).get<double>() == Approx(0.0085));
    CHECK(grid.at("metadata").at("madf_length_unit") == "mm");
  }
  CHECK(Json::parse(bench.bytes("e.json")).at("voxel_size_mm").get<double>() == Approx(0.0085));
  bench.mustRun("convert b.vdb f.vdb --voxel-size 0.02mm -q");
  CHECK(infoOf(bench, "f.vdb").at("grids").at(0).at("voxel_size_mm").get<double>() == Approx(0.02));

  bench.mustRun("generate snow a.vdb --size 16 --length 6");
  CHECK(bench.mustRun("segment a.vdb g.vdb").find("no physical size") != std::string::npos);
}

TEST_CASE("cli: labels are written over the whole domain", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --dims 50x40x44 --count 3 --radius 6:8");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("convert g.vdb g.raw --grid grain --type int32");
  CHECK(bench.bytes("g.raw").size() == 50 * 40 * 44 * sizeof(int32_t));
  bench.mustRun("convert g.vdb g.tif --grid grain --type int32");
  bench.mustRun("convert g.tif h.raw");
  CHECK(bench.bytes("h.raw") == bench.bytes("g.raw"));
  bench.mustRun("convert g.vdb m.mhd --grid grain --type int32");
  CHECK(infoOf(bench, "m.mhd").at("size") == Json({50, 40, 44}));
}

TEST_CASE("cli: labels in a TIFF are uint16, in other formats int32", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --dims 50x40x44 --count 3 --radius 6:8 --voxel-size 8.5um");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("convert g.vdb g.raw --grid grain");
  for (const std::string to : {"g.tif", "g.nrrd", "g.npy"}) {
    bench.mustRun("convert g.vdb " + to + " --grid grain");
    const Json info = infoOf(bench, to);
    CHECK(info.at("type") == (to == "g.tif" ? "uint16" : "int32"));
    CHECK(info.at("size") == Json({50, 40, 44}));
    CHECK(info.contains("voxel_size_mm") == (to != "g.npy"));
    if (to != "g.npy") CHECK(info.at("voxel_size_mm") == 0.0085);
    bench.mustRun("convert " + to + " back.raw --type int32");
    CHECK(bench.bytes("back.raw") == bench.bytes("g.raw"));
    bench.mustRun("compare g.vdb " + to);
  }
}

TEST_CASE("cli: labels of another program become a VDB that all verbs read", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.tif");
  const std::string said = bench.mustRun("convert s.truth.tif l.vdb --labels --voxel-size 10um");
  CHECK(said.find("l.vdb: grid 'grain'") == 0);
  const Json grid = gridOf(infoOf(bench, "l.vdb"), "grain");
  CHECK(grid.at("value_type") == "int32");
  CHECK(grid.at("metadata").at("madf_domain_max") == Json({39, 39, 39}));
  CHECK(grid.at("voxel_size_mm") == 0.01);
  bench.mustRun("convert l.vdb back.raw");
  bench.mustRun("convert s.truth.tif there.raw --out-type int32");
  CHECK(bench.bytes("back.raw") == bench.bytes("there.raw"));

  bench.mustRun("measure l.vdb tables");
  bench.mustRun("measure s.truth.tif wanted --voxel-size 10um");
  for (const std::string table : {"/grains.csv", "/bonds.csv"})
    CHECK(bench.bytes("tables" + table) == bench.bytes("wanted" + table));
  const auto digest = [&](const std::string& folder) {
    return Json::parse(bench.bytes(folder + "/sample.json")).at("labels_digest");
  };
  CHECK(digest("tables") == digest("wanted"));
  bench.mustRun("export l.vdb m.ply");
  bench.mustRun("render l.vdb m.png --size 64");
  bench.mustRun("compare l.vdb s.truth.tif");
  // Balls that were not kept are those of a closed segmentation.
  bench.mustRun("export l.vdb c.csv --as clumps");
  bench.mustRun("segment s.tif g.vdb --keep balls --boundary closed --tidy 0");
  bench.mustRun("segment s.tif without.vdb --boundary closed --tidy 0");
  bench.mustRun("export g.vdb kept.csv --as clumps");
  bench.mustRun("export without.vdb computed.csv --as clumps");
  CHECK(bench.bytes("c.csv").size() > 100);
  CHECK(bench.bytes("computed.csv") == bench.bytes("kept.csv"));
  // Those that were kept reach into grains that were dropped since.
  for (const std::string labels : {"g", "without"}) {
    bench.mustRun("edit " + labels + ".vdb few.vdb --keep 2,3");
    bench.mustRun("export few.vdb " + labels + ".csv --as clumps");
  }
  CHECK(bench.bytes("without.csv") == bench.bytes("g.csv"));

  bench.write("v.raw", std::string({1, 0, 0, 0, -1, -1, -1, -1}));
  Outcome outcome = bench.run("convert v.raw v.vdb --dims 2x1x1 --type int32 --labels");
  CHECK(outcome.exitCode == 1);
  CHECK(outcome.err.find("the label -1") != std::string::npos);
  outcome = bench.run("convert v.raw v.vdb --dims 2x1x1 --type uint32 --labels");
  CHECK(outcome.exitCode == 1);
  CHECK(outcome.err.find("4294967295") != std::string::npos);
  CHECK(bench.names().count("v.vdb") == 0);
  bench.write("m.raw", std::string(8, '\1'));
  CHECK(bench.mustRun("convert m.raw m.vdb --dims 2x2x2 --type uint8 --labels").find("mask?") !=
        std::string::npos);
  CHECK(bench.mustRun("measure m.raw mask --dims 2x2x2 --type uint8")
            .find("mask: 1 grain, 0 bonds: is this a mask? segment it first\n") == 0);
}

TEST_CASE("cli: convert selects among the grid that it would copy", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep distance,manifold");
  bench.mustRun("convert g.vdb g.npy");
  for (const std::string selection : {"--phase 2", "--threshold 2", "--range 1:2"}) {
    bench.mustRun("convert g.vdb one.vdb " + selection);
    bench.mustRun("convert g.npy wanted.vdb " + selection);
    bench.mustRun("convert one.vdb one.raw");
    bench.mustRun("convert wanted.vdb wanted.raw");
    CHECK(bench.bytes("one.raw") == bench.bytes("wanted.raw"));
    CHECK(bench.bytes("one.raw").find('\1') != std::string::npos);
  }
}

TEST_CASE("cli: an object in a file of whole blocks and its inverse make the box", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 64 --count 5 --radius 12");
  bench.mustRun("convert s.vdb s.raw --grid object");
  const std::string object = bench.bytes("s.raw");
  for (const std::string region : {"", " --roi cylinder:z:31.5,31.5:30"}) {
    bench.mustRun("convert s.vdb i.raw --grid object --invert" + region + " -q");
    const std::string inverse = bench.bytes("i.raw");
    int64_t expected = 0;
    for (size_t i = 0; i < object.size(); ++i) {
      const double x = double(i % 64) - 31.5, y = double(i / 64 % 64) - 31.5;
      expected += (region.empty() || x * x + y * y <= 900) && object[i] == 0;
      if (region.empty()) REQUIRE(inverse[i] != object[i]);
    }
    CHECK(std::count(inverse.begin(), inverse.end(), '\1') == expected);
  }
}

TEST_CASE("cli: a header of a RAW file is skipped", "[cli]") {
  const Bench bench;
  bench.write("plain.raw", ramp());
  bench.write("headed.raw", "a header of any kind" + ramp());
  const std::string dims = " --dims 8x1x1 --type uint8";
  bench.mustRun("convert headed.raw out.raw --skip 20" + dims);
  CHECK(bench.bytes("out.raw") == ramp());
  bench.mustRun("convert headed.raw out.raw --dims 3x1x1 --type uint16 --big-endian --skip 22");
  CHECK(bench.bytes("out.raw") == std::string("\3\2\5\4\7\6", 6));
  bench.mustRun("compare headed.raw headed.raw --skip 20" + dims);
  for (const auto& [skip, says] : {std::pair<const char*, const char*>{"", "a header of 20 bytes"},
                                   {" --skip 19", "a header of 20 bytes"},
                                   {" --skip 21", "20 bytes"},
                                   {" --skip 99", "99 are to be skipped"}}) {
    const Outcome outcome = bench.run("info headed.raw" + dims + skip);
    CHECK(outcome.exitCode == 1);
    CHECK(outcome.err.find(says) != std::string::npos);
  }
}
