// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the verbs of the command do, run as a user runs them; what they refuse: cli_errors_test.cc.

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/program.h"

using namespace vdb_madf::test;
using Json = nlohmann::json;

namespace {

const std::string kSpheres = "generate spheres --size 40 --count 5 --radius 6:9 ";
const std::string kSnow = "generate snow --size 48 --length 14 --voxel-size 10um ";

Json infoOf(const Bench& bench, const std::string& file) {
  return Json::parse(bench.mustRun("info " + file + " --json -"));
}

Json gridOf(const Json& info, const std::string& name) {
  for (const Json& grid : info.at("grids"))
    if (grid.at("name") == name) return grid;
  FAIL("no grid " << name);
  return {};
}

std::set<std::string> gridsOf(const Json& info) {
  std::set<std::string> names;
  for (const Json& grid : info.at("grids")) names.insert(grid.at("name").get<std::string>());
  return names;
}

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
  for (const std::string verb : {"generate", "convert", "segment", "remerge", "sweep", "measure",
                                 "compare", "render", "export", "info"}) {
    CHECK(help.find("  " + verb + " ") != std::string::npos);
    CHECK(bench.mustRun(verb + " --help").find("Example:\n  vdb_madf " + verb) !=
          std::string::npos);
  }
  for (const std::string kind : {"spheres", "pack", "snow", "sintered"})
    CHECK(bench.mustRun("generate " + kind + " --help").find("vdb_madf generate " + kind) !=
          std::string::npos);
  CHECK(bench.mustRun("--version").find("vdb_madf ") == 0);
}

TEST_CASE("cli: generate makes the same file of the same seed", "[cli]") {
  const Bench bench;
  for (const std::string kind :
       {"spheres --size 40 --count 4 --radius 6:8", "pack --size 24 --radius 3:5",
        "snow --dims 24x16x20 --length 8", "sintered --size 40 --count 4 --radius 6:9"}) {
    CAPTURE(kind);
    bench.mustRun("generate " + kind + " a.vdb");
    bench.mustRun("generate " + kind + " b.vdb --threads 1");
    bench.mustRun("generate " + kind + " c.vdb --seed 2");
    CHECK(bench.bytes("a.vdb") == bench.bytes("b.vdb"));
    CHECK(bench.bytes("a.vdb") != bench.bytes("c.vdb"));
  }
}

TEST_CASE("cli: generate writes the truth beside an image", "[cli]") {
  const Bench bench;
  for (const std::string ending : {".vdb", ".raw", ".tif", ".mhd"})
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
      {"--range 2:4", "00111000"},         {"--invert", "10000000"},
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
  bench.mustRun("convert b.vdb f.vdb --voxel-size 0.02mm");
  CHECK(infoOf(bench, "f.vdb").at("grids").at(0).at("voxel_size_mm").get<double>() == Approx(0.02));

  bench.mustRun("generate snow a.vdb --size 16 --length 6");
  CHECK(bench.mustRun("segment a.vdb g.vdb").find("no physical size") != std::string::npos);
}

TEST_CASE("cli: segment reports what it did as JSON", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  const std::string printed = bench.mustRun("segment s.vdb g.vdb --gamma 4 --json j.json");
  CHECK(printed.find("grains") != std::string::npos);
  const Json json = Json::parse(bench.bytes("j.json"));
  for (const char* key : {"object_voxels",   "medial_balls",  "kept_balls",
                          "critical_points", "grains",        "largest_squared_distance",
                          "leaves",          "porosity",      "seconds_read",
                          "seconds_write",   "seconds_total", "peak_memory_bytes",
                          "threads",         "voxel_size_mm", "gamma",
                          "theta",           "boundary",      "merge",
                          "adjacency",       "input",         "output"})
    CHECK(json.count(key) == 1);
  CHECK(json.at("gamma") == 4);
  CHECK(json.at("theta") == -0.9);
  CHECK(json.at("merge") == "both");
  CHECK(json.at("adjacency") == "manifold");
  CHECK(json.at("boundary") == "open");
  CHECK(json.at("grains").get<int>() > 1);
  CHECK(json.at("porosity").get<double>() ==
        Approx(1 - json.at("object_voxels").get<double>() / (48 * 48 * 48)));

  double sum = 0;
  int stages = 0;
  for (const auto& [key, value] : json.items()) {
    if (key.rfind("seconds_", 0) != 0 || key == "seconds_total") continue;
    CHECK(value.get<double>() >= 0);
    sum += value.get<double>();
    ++stages;
  }
  CHECK(stages >= 8);
  CHECK(sum == Approx(json.at("seconds_total").get<double>()));

  const Json alone = Json::parse(bench.mustRun("segment s.vdb g.vdb --json -"));
  CHECK(alone.at("grains").get<int>() > 1);
  CHECK(Json::parse(bench.mustRun("segment s.vdb g.vdb --json /dev/stdout")).count("grains") == 1);
  CHECK(bench.mustRun("segment s.vdb g.vdb --json /dev/null -q") == "");
  CHECK(bench.mustRun("segment s.vdb g.vdb -q") == "");
}

TEST_CASE("cli: segment keeps the grids that are asked for, each with its metadata", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb");
  CHECK(gridsOf(infoOf(bench, "g.vdb")) == std::set<std::string>{"grain"});
  bench.mustRun("segment s.vdb g.vdb --keep distance,power,manifold,balls --theta -0.7");
  const Json info = infoOf(bench, "g.vdb");
  CHECK(gridsOf(info) == std::set<std::string>{"grain", "distance_squared", "power", "manifold",
                                               "balls", "balls_cell_size"});
  for (const Json& grid : info.at("grids")) {
    CAPTURE(grid.at("name"));
    CHECK(grid.at("value_type") == "int32");
    const Json& metadata = grid.at("metadata");
    for (const char* key :
         {"madf_version", "madf_gamma", "madf_boundary", "madf_merge", "madf_adjacency",
          "madf_domain_min", "madf_domain_max", "madf_voxel_size_m", "madf_length_unit",
          "madf_source", "madf_grains", "madf_object_voxels", "madf_critical_points"})
      CHECK(metadata.count(key) == 1);
    CHECK(metadata.at("madf_theta") == -0.7);
  }
  CHECK(gridOf(info, "manifold").at("metadata").count("madf_manifold_graph") == 1);
  CHECK(gridOf(info, "balls").at("active_voxels") ==
        gridOf(info, "balls").at("metadata").at("madf_medial_balls"));
}

TEST_CASE("cli: segment writes the same bytes for any number of threads", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  for (const std::string options : {"", " --gamma 3 --keep distance,power,manifold,balls"}) {
    bench.mustRun("segment s.vdb one.vdb --threads 1" + options);
    bench.mustRun("segment s.vdb two.vdb --threads 2" + options);
    CHECK(bench.bytes("one.vdb") == bench.bytes("two.vdb"));
  }
}

TEST_CASE("cli: the paper's merging is a short form", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb short.vdb --paper");
  bench.mustRun("segment s.vdb long.vdb --merge angle --adjacency cell --theta -0.8");
  CHECK(bench.bytes("short.vdb") == bench.bytes("long.vdb"));
  bench.mustRun("segment s.vdb short.vdb --paper --theta -0.6");
  bench.mustRun("segment s.vdb long.vdb --merge angle --adjacency cell --theta -0.6");
  CHECK(bench.bytes("short.vdb") == bench.bytes("long.vdb"));
}

TEST_CASE("cli: remerge equals a fresh segmentation", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold");
  for (const std::string options :
       {"", " --theta -0.5", " --theta 1", " --merge angle --adjacency cell", " --merge neck"}) {
    CAPTURE(options);
    bench.mustRun("remerge g.vdb re.vdb" + options);
    bench.mustRun("segment s.vdb fresh.vdb --keep manifold" + options);
    CHECK(bench.bytes("re.vdb") == bench.bytes("fresh.vdb"));
    bench.mustRun("remerge re.vdb back.vdb");  // the manifolds went along
    CHECK(bench.bytes("back.vdb") == bench.bytes("g.vdb"));
  }
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
  bench.mustRun("convert g.vdb g.mhd --grid grain --type int32");
  CHECK(infoOf(bench, "g.mhd").at("size") == Json({50, 40, 44}));
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

TEST_CASE("cli: sweep gives a line for each choice, equal to its segmentation", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun(
      "sweep s.vdb a.csv --gamma 0,9 --theta -1:-0.7:0.1,-0.95 --merge angle,both --small 50 "
      "--plot a.svg");
  std::istringstream csv(bench.bytes("a.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  REQUIRE(lines.size() == 1 + 2 * 2 * 5);
  CHECK(lines[0].find("gamma,merge,theta,grains,median_voxels,small_grains,") == 0);
  for (const auto& [line, options] :
       {std::pair<size_t, std::string>{1, "--gamma 0 --theta -1 --merge angle"},
        {3, "--gamma 0 --theta -0.8 --merge angle"},
        {15, "--gamma 9 --theta -0.95 --merge angle"},
        {19, "--gamma 9 --theta -0.7 --merge both"}}) {
    const Json json = Json::parse(bench.mustRun("segment s.vdb g.vdb --json - " + options));
    std::istringstream fields(lines[line]);
    std::string gamma, merge, theta, grains;
    for (std::string* field : {&gamma, &merge, &theta, &grains}) std::getline(fields, *field, ',');
    CHECK(std::stoll(gamma) == json.at("gamma"));
    CHECK(merge == json.at("merge"));
    CHECK(std::stod(theta) == json.at("theta"));
    CHECK(std::stoll(grains) == json.at("grains"));
  }
  const std::string svg = bench.bytes("a.svg");
  CHECK(svg.find("<svg ") == 0);
  CHECK(svg.substr(svg.size() - 7) == "</svg>\n");
  CHECK(svg.find("nan") == std::string::npos);
  size_t curves = 0;
  for (size_t at = 0; (at = svg.find("<polyline", at)) != std::string::npos; ++at) ++curves;
  CHECK(curves == 3 * 4);

  bench.mustRun(
      "sweep s.vdb b.csv --gamma 0,9 --theta -1:-0.7:0.1,-0.95 --merge angle,both --small 50 "
      "--plot b.svg --threads 1");
  CHECK(bench.bytes("a.csv") == bench.bytes("b.csv"));
  CHECK(svg == bench.bytes("b.svg"));
}

TEST_CASE("cli: compare finds a file equal to itself", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun(kSpheres + "s.tif");
  for (const std::string pair : {"s.vdb s.vdb", "s.vdb s.truth.tif", "s.truth.tif s.vdb"}) {
    CAPTURE(pair);
    const Json json = Json::parse(bench.mustRun("compare " + pair + " --json -"));
    CHECK(json.at("truth_grains") == 5);
    CHECK(json.at("test_grains") == 5);
    CHECK(json.at("misclassified_percent") == 0);
    CHECK(json.at("adjusted_rand_index") == 1);
    CHECK(json.at("variation_of_information_bits").get<double>() == Approx(0).margin(1e-12));
  }
  bench.mustRun("segment s.vdb one.vdb --theta 1 --merge angle --adjacency cell");
  const Json json = Json::parse(bench.mustRun("compare s.vdb one.vdb --json -"));
  CHECK(json.at("test_grains").get<int>() < 5);
  CHECK(json.at("adjusted_rand_index").get<double>() < 1);
  CHECK(bench.mustRun("compare s.vdb one.vdb").find("misclassified") != std::string::npos);
  CHECK(bench.mustRun("compare s.vdb one.vdb -q") == "");

  CHECK(json.at("same_topology") == true);
  CHECK(json.at("splits").empty());
  REQUIRE(json.at("merges").size() == 1);
  CHECK(json.at("merges")[0].at("truth").size() >= 2);
  bench.mustRun("compare s.vdb one.vdb --grains grains.csv --confusion confusion.csv");
  const auto lines = [&](const std::string& file) {
    const std::string text = bench.bytes(file);
    return std::count(text.begin(), text.end(), '\n');
  };
  CHECK(lines("grains.csv") == 1 + 5 + json.at("test_grains").get<int>());
  CHECK(lines("confusion.csv") >= 1 + 5);
}

TEST_CASE("cli: compare says when the grids differ in topology", "[cli]") {
  const Bench bench;
  bench.write("a.raw", std::string("\1\1\2\2", 4));
  bench.write("b.raw", std::string("\0\1\2\2", 4));
  const std::string pair = "compare a.raw b.raw --dims 4x1x1 --type uint8";
  CHECK(bench.mustRun(pair).find("differ in topology") != std::string::npos);
  CHECK(Json::parse(bench.mustRun(pair + " --json -")).at("same_topology") == false);
  CHECK(bench.mustRun(pair + " --grains -") ==
        "side,grain,voxels,partner,overlap_voxels,intersection_over_union,pieces\n"
        "truth,1,2,1,1,0.5,1\ntruth,2,2,2,2,1,1\ntest,1,1,1,1,0.5,1\ntest,2,2,2,2,1,1\n");
  CHECK(bench.mustRun(pair + " --confusion -") == "truth,test,voxels\n1,0,1\n1,1,1\n2,2,2\n");
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
  CHECK(vdb.at("format") == "vdb");
  CHECK(gridOf(vdb, "object").at("metadata").at("madf_domain_max") == "[19, 15, 11]");
  CHECK(bench.mustRun("info s.vdb").find("grid object") != std::string::npos);
}

TEST_CASE("cli: an empty object has no grains", "[cli]") {
  const Bench bench;
  bench.write("zero.raw", std::string(64, '\0'));
  for (const std::string boundary : {"open", "closed"}) {
    const Json json = Json::parse(bench.mustRun(
        "segment zero.raw g.vdb --dims 4x4x4 --type uint8 --json - --boundary " + boundary));
    CHECK(json.at("grains") == 0);
    CHECK(json.at("porosity") == 1);
    bench.mustRun("render g.vdb g.png");
    bench.mustRun("compare g.vdb g.vdb");
    bench.mustRun("convert g.vdb g.raw");
    CHECK(bench.bytes("g.raw") == std::string(4 * 64, '\0'));
  }
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

TEST_CASE("cli: segment --dry-run says what it would take, and does nothing", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack p.vdb --size 160 --radius 8:16");
  const auto before = bench.names();
  const Json estimate = Json::parse(bench.mustRun("segment p.vdb --dry-run --json -"));
  CHECK(bench.names() == before);
  CHECK(estimate.at("fits") == true);
  const Json done = Json::parse(bench.mustRun("segment p.vdb g.vdb --json -"));
  CHECK(estimate.at("object_voxels") == done.at("object_voxels"));
  CHECK(estimate.at("leaves") == done.at("leaves"));
  const double needed = estimate.at("estimated_memory_bytes"), peak = done.at("peak_memory_bytes");
  CHECK(needed > 0.5 * peak);
  CHECK(needed < 3 * peak);
  CHECK(bench.mustRun("segment p.vdb --dry-run --max-memory 1M").find("it does not fit") !=
        std::string::npos);
}
