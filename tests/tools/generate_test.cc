// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// vdb_madf generate, run as a user runs it.

#include <string>
#include <utility>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;

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
