// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the verbs of the command do, run as a user runs them; segmenting and what follows from it:
// cli_segment_test.cc; what they refuse: cli_errors_test.cc.

#include <openvdb/version.h>

#include <cstring>
#include <filesystem>
#include <sstream>

#include "support/catch.h"
#include "support/command_runs.h"
#include "vdb_madf/base/version.h"

using namespace vdb_madf::test;
using vdb_madf::kVersion;

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

TEST_CASE("cli: help names every verb and gives an example", "[cli]") {
  const Bench bench;
  const std::string help = bench.mustRun("--help");
  for (const std::string verb :
       {"generate", "convert", "segment", "remerge", "edit", "sweep", "hierarchy", "measure",
        "verify", "compare", "track", "render", "report", "export", "info"}) {
    CHECK(help.find("  " + verb + " ") != std::string::npos);
    CHECK(bench.mustRun(verb + " --help").find("Example:\n  vdb_madf " + verb) !=
          std::string::npos);
  }
  for (const std::string kind :
       {"spheres", "pack", "snow", "sintered", "particles", "bed", "evolve"})
    CHECK(bench.mustRun("generate " + kind + " --help").find("vdb_madf generate " + kind) !=
          std::string::npos);
  CHECK(bench.mustRun("help") == help);
  CHECK(bench.mustRun("help segment") == bench.mustRun("segment --help"));
  CHECK(bench.mustRun("help generate snow") == bench.mustRun("generate snow --help"));
}

TEST_CASE("cli: the version says what the command was built with and runs with", "[cli]") {
  const Bench bench;
  std::istringstream version(bench.mustRun("--version"));
  std::string line;
  std::getline(version, line);
  CHECK(line == std::string("vdb_madf ") + kVersion);
  std::getline(version, line);
  CHECK(line == "OpenVDB " OPENVDB_LIBRARY_VERSION_STRING);
  std::getline(version, line);
  const std::string cpu = bytesOf("/proc/cpuinfo");
  const auto processorHas = [&](const std::string& flag) {
    return cpu.find(" " + flag) != std::string::npos;
  };
  const bool isV4 = line == "SIMD level x86-64-v4", isV3 = line == "SIMD level x86-64-v3";
  CHECK((isV4 || isV3 || line == "SIMD level baseline"));
  if (isV4) CHECK(processorHas("avx512vl"));
  if (isV3) CHECK(processorHas("avx2"));
  std::getline(version, line);
  bench.write("a.h5", "\x89HDF\r\n\x1a\n" + std::string(100, 'a'));
  const bool isBuiltIn = bench.run("info a.h5").err.find("libhdf5-dev") == std::string::npos;
  CHECK((line == "HDF5 is read and written") == isBuiltIn);
  CHECK((line.find("HDF5 is not read: ") == 0) != isBuiltIn);
  std::getline(version, line);
  bench.mustRun("generate spheres s.vdb --size 40 --count 5 --radius 6:9");
  const bool areWritten =
      bench.run("report s.vdb r.html --grid truth").err.find("esbuild") == std::string::npos;
  CHECK((line == "Reports are written") == areWritten);
  CHECK((line.find("Reports are not written: ") == 0) != areWritten);
  CHECK_FALSE(std::getline(version, line));
}

TEST_CASE("cli: generate makes the same file of the same seed", "[cli]") {
  const Bench bench;
  for (const std::string kind :
       {"spheres --size 40 --count 4 --radius 6:8", "pack --size 24 --radius 3:5",
        "snow --dims 24x16x20 --length 8", "sintered --size 40 --count 4 --radius 6:9",
        "particles --size 40 --count 4 --radius 6:9 --shape polyhedra",
        "particles --size 40 --count 4 --radius 4:6 --shape rods --aspect 3:5",
        "bed --size 40 --radius 6:9 --rounds 2",
        "particles --size 40 --count 4 --radius 6:9 --surface 1:5 --scan-noise 1:0.2"}) {
    CAPTURE(kind);
    bench.mustRun("generate " + kind + " a.vdb");
    bench.mustRun("generate " + kind + " b.vdb --threads 1");
    bench.mustRun("generate " + kind + " c.vdb --seed 2");
    CHECK(bench.bytes("a.vdb") == bench.bytes("b.vdb"));
    CHECK(bench.bytes("a.vdb") != bench.bytes("c.vdb"));
  }
}

TEST_CASE("cli: generate draws the balls of a list", "[cli]") {
  const Bench bench;
  bench.write("beads.txt", "# beads\n1 0 0 0\n2 1.9,0,0\n3 0 2 0\n");
  bench.mustRun("generate balls beads.txt a.vdb --numbered --radius 6");
  CHECK(infoOf(bench, "a.vdb").at("grids").at(0).at("metadata").at("madf_domain_max") ==
        Json({23, 23, 11}));
  bench.mustRun("generate balls beads.txt b.tif --numbered --radius 6 --size 12");
  CHECK(bench.names().count("b.truth.tif") == 1);
  const std::pair<const char*, const char*> cases[] = {
      {"beads.txt o.vdb --radius 6", "beads.txt: line 2: the radius must be above 0"},
      {"none.txt o.vdb --radius 6", "none.txt"},
      {"beads.txt o.vdb", "--radius"},
      {"beads.txt o.vdb --numbered --radius 0", "radius must be above 0"},
      {"beads.txt o.vdb --numbered --radius 6:7", "--radius"},
      {"beads.txt o.vdb --numbered --radius 9999", "voxels along x"},
      {"b.tif b.tif --radius 6", "b.tif"}};
  for (const auto& [arguments, says] : cases) {
    CAPTURE(arguments);
    const Outcome outcome = bench.run(std::string("generate balls ") + arguments);
    CHECK(outcome.exitCode != 0);
    CHECK_THAT(outcome.err, Contains(says));
    CHECK(bench.names().count("o.vdb") == 0);
  }
}

TEST_CASE("cli: generate writes a gray scan of the same bodies", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "plain.tif");
  bench.mustRun(kSpheres + "sharp.tif --gray clean.tif --voxel-size 8.5um");
  bench.mustRun(kSpheres + "s.tif --gray noisy.npy --scan-noise 1:0.1");
  bench.mustRun(kSpheres + "t.tif --gray again.npy --scan-noise 1:0.1 --threads 1");
  CHECK(bench.bytes("s.tif") == bench.bytes("plain.tif"));
  CHECK(bench.bytes("s.truth.tif") == bench.bytes("plain.truth.tif"));
  CHECK(bench.bytes("noisy.npy") == bench.bytes("again.npy"));
  const Json info = infoOf(bench, "clean.tif");
  CHECK(info.at("type") == "uint16");
  CHECK(info.at("size") == Json({40, 40, 40}));
  CHECK(info.at("voxel_size_mm") == 0.0085);
  // Where half of the voxel is solid, nearly.
  bench.mustRun("convert clean.tif cut.raw --threshold 20000");
  bench.mustRun("convert plain.tif plain.raw");
  const std::string cut = bench.bytes("cut.raw"), plain = bench.bytes("plain.raw");
  REQUIRE(cut.size() == plain.size());
  size_t others = 0, solid = 0;
  for (size_t i = 0; i < cut.size(); ++i) {
    others += (cut[i] != 0) != (plain[i] != 0);
    solid += plain[i] != 0;
  }
  CHECK(100 * others < solid);
}

TEST_CASE("cli: generate writes the truth beside an image", "[cli]") {
  const Bench bench;
  for (const std::string ending : {".vdb", ".mhd", ".raw", ".tif"})
    bench.mustRun(kSpheres + "s" + ending);
  CHECK(gridsOf(infoOf(bench, "s.vdb")) == std::set<std::string>{"object", "truth"});
  for (const std::string name : {"s.truth.raw", "s.truth.tif", "s.truth.mhd", "s.raw"})
    CHECK(bench.names().count(name) == 1);
  bench.mustRun("convert s.vdb labels.raw --grid truth --type int32");
  CHECK(bench.bytes("labels.raw") == bench.bytes("s.truth.raw"));
  bench.mustRun("convert s.truth.tif labels.raw");
  CHECK(bench.bytes("labels.raw") == bench.bytes("s.truth.raw"));

  bench.mustRun("generate pack p.tif --size 24 --radius 3:5");  // has no truth
  CHECK(bench.names().count("p.truth.tif") == 0);
}

TEST_CASE("cli: generate samples the same bodies by unequal voxels", "[cli]") {
  const Bench bench;
  const std::string size = " --dims 40x39x42 ";
  for (const std::string kind : {"spheres", "sintered", "particles"}) {
    CAPTURE(kind);
    const std::string command = "generate " + kind + size + "--count 4 --radius 6:9 --voxel-size ";
    bench.mustRun(command + "1um cubes.npy");
    bench.mustRun(command + "1x3x1um third.npy");
    const std::string cubes = bench.bytes("cubes.truth.npy"),
                      third = bench.bytes("third.truth.npy");
    const size_t row = 40 * sizeof(int32_t);
    REQUIRE(cubes.size() == 128 + 42 * 39 * row);
    REQUIRE(third.size() == 128 + 42 * 13 * row);
    for (size_t z = 0; z < 42; ++z)
      for (size_t y = 0; y < 13; ++y)
        REQUIRE(third.substr(128 + (z * 13 + y) * row, row) ==
                cubes.substr(128 + (z * 39 + 3 * y + 1) * row, row));
  }
  bench.mustRun("generate pack --size 40 --radius 4:6 --voxel-size 2x1x1um pack.mhd");
  const Json pack = infoOf(bench, "pack.mhd");
  CHECK(pack.at("size") == Json({20, 40, 40}));
  CHECK(pack.at("voxel_size_mm").at(0) == Approx(0.002));
  CHECK(pack.at("voxel_size_mm").at(2) == Approx(0.001));
}

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

TEST_CASE("cli: volumes come from standard input and go to standard output", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.raw --size 20 --count 3 --radius 4:5");
  const std::string dims = " --dims 20x20x20 --type uint8";
  bench.mustRun("convert s.raw s.vdb" + dims);
  bench.mustRun("convert s.raw s.npy" + dims);
  bench.mustRun("convert s.raw s.nrrd" + dims);
  bench.mustRun("convert s.raw s.tif" + dims);
  const auto piped = [&](const std::string& arguments, const std::string& bytes) {
    RunOptions options;
    options.piped = bytes;
    const Outcome outcome = bench.run(arguments, options);
    CHECK(outcome.err == "");
    CHECK(outcome.exitCode == 0);
    return outcome.out;
  };
  for (const std::string name : {"s.npy", "s.nrrd", "s.tif", "s.vdb"}) {
    CAPTURE(name);
    CHECK(piped("convert - raw:-", bench.bytes(name)) == bench.bytes("s.raw"));
  }
  CHECK(piped("convert - npy:-" + dims, bench.bytes("s.raw")) == bench.bytes("s.npy"));
  CHECK(piped("convert - nrrd:- --skip 1" + dims, "x" + bench.bytes("s.raw")) ==
        bench.bytes("s.nrrd"));
  bench.mustRun("segment s.vdb g.npy --boundary closed");
  CHECK(piped("segment - npy:- --boundary closed", bench.bytes("s.npy")) == bench.bytes("g.npy"));
  CHECK(Json::parse(piped("info - --json -", bench.bytes("s.npy"))).at("size") ==
        Json({20, 20, 20}));
  CHECK(piped("sweep - - --merge both --theta -1", bench.bytes("s.npy")).find("gamma,") == 0);
  CHECK(piped("export - csv:- --as network", bench.bytes("g.npy")).find("pore.") == 0);

  RunOptions redirected;
  redirected.in = bench.path("s.npy");
  CHECK(bench.run("convert - raw:-", redirected).out == bench.bytes("s.raw"));
  const Outcome none = bench.run("info -");
  CHECK(none.exitCode == 1);
  CHECK(none.err.find("-: is no image") != std::string::npos);
}

TEST_CASE("cli: render writes a PNG", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("render s.vdb s.png");
  const std::string png = bench.bytes("s.png");
  REQUIRE(png.size() > 33);
  CHECK(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  CHECK(png.substr(12, 4) == "IHDR");
  const auto number = [&](size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | uint8_t(png[at + i]);
    return value;
  };
  CHECK(number(16) >= 2 * 480);  // two columns, 12 pixels a voxel
  CHECK(number(20) >= 2 * 480);
  bench.mustRun("render s.vdb t.png --threads 1");
  CHECK(bench.bytes("t.png") == png);
}

TEST_CASE("cli: a length is understood as it is written", "[cli]") {
  const Bench bench;
  for (const std::string length : {"8.5um", "8.5 um", "8.5UM", "8.5\u00b5m", "8.5 \u03bcm",
                                   "8.5 microns", "0.0085mm", "8500 nm", "8.5e-6 m"}) {
    CAPTURE(length);
    const Outcome outcome = bench.run(std::vector<std::string>{
        "generate", "snow", "a.tif", "--size", "8", "--length", "4", "--voxel-size", length});
    CHECK(outcome.err == "");
    CHECK(infoOf(bench, "a.tif").at("voxel_size_mm") == Approx(0.0085));
  }
}

TEST_CASE("cli: info says what is in a file", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.raw --dims 20x16x12 --length 6");
  bench.mustRun("convert s.raw s.tif --dims 20x16x12 --type uint8");
  const Json image = infoOf(bench, "s.tif");
  CHECK(image.at("format") == "tiff");
  CHECK(image.at("size") == Json({20, 16, 12}));
  CHECK(image.at("type") == "uint8");
  CHECK(bench.mustRun("info s.raw --dims 20x16x12 --type uint8").find("[20,16,12]") !=
        std::string::npos);
  bench.mustRun("convert s.tif s.vdb");
  const Json vdb = infoOf(bench, "s.vdb");
  CHECK(gridOf(vdb, "object").at("metadata").at("madf_domain_min") == Json({0, 0, 0}));
  CHECK(gridOf(vdb, "object").at("metadata").at("madf_domain_max") == Json({19, 15, 11}));
  CHECK(vdb.at("format") == "vdb");
  CHECK(bench.mustRun("info s.vdb").find("grid object") != std::string::npos);
}

TEST_CASE("cli: an output replaces what was there, the content decides on the format", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.tif --size 16 --length 6");
  bench.write("o.vdb", "something else");
  bench.mustRun("segment s.tif o.vdb");
  CHECK(gridsOf(infoOf(bench, "o.vdb")) == std::set<std::string>{"grain"});
  std::filesystem::create_symlink("real.vdb", bench.path("link.vdb"));
  bench.write("real.vdb", "something else");
  bench.mustRun("segment s.tif link.vdb");
  CHECK(std::filesystem::is_symlink(bench.path("link.vdb")));
  CHECK(bench.bytes("real.vdb") == bench.bytes("o.vdb"));
  bench.write("s.dat", bench.bytes("s.tif"));
  bench.write("o.dat", bench.bytes("o.vdb"));
  CHECK(infoOf(bench, "s.dat").at("format") == "tiff");
  CHECK(infoOf(bench, "o.dat").at("format") == "vdb");
}
