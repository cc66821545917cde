// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verb 'export', run as a user runs it; what is in the files: the tests of their writers.

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "support/catch.h"
#include "support/program.h"

using namespace vdb_madf::test;

namespace {

void makeLabels(const Bench& bench) {
  bench.mustRun("generate spheres s.vdb --size 40 --count 5 --radius 6:9 --voxel-size 10um");
  bench.mustRun("segment s.vdb g.vdb --keep balls");
}

/// The bytes of the files of a folder, by their names within.
std::map<std::string, std::string> treeOf(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) {
      std::ifstream file(entry.path(), std::ios::binary);
      files[entry.path().lexically_relative(folder).string()] =
          std::string(std::istreambuf_iterator<char>(file), {});
    }
  return files;
}

}  // namespace

TEST_CASE("cli: export writes every kind, the same for any number of threads", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  for (const std::string what : {"m.ply",
                                 "m.obj",
                                 "m.stl --smooth 0",
                                 "t.ply --triangles 3000",
                                 "m.glb",
                                 "t.glb --triangles 3000 --smooth 0",
                                 "m.vtp --as mesh",
                                 "v.vdb --as viz",
                                 "w.vdb --as viz --max-dim 16",
                                 "l.vdb --as lod",
                                 "g2.vdb --as grids",
                                 "b.vdb --as grids --bool",
                                 "s2.vdb --as surface",
                                 "i.vti",
                                 "p.dat --as palabos",
                                 "c.vti --compress",
                                 "n.vtp --as network",
                                 "n.graphml",
                                 "n.csv --as network",
                                 "c.csv --as clumps",
                                 "c.txt --as clumps --balls 3",
                                 "c.data --as clumps --uncovered 0.1",
                                 "a.txt --as clumps --apart",
                                 "a.data --as clumps --bonds bonds.csv --cover cover.csv",
                                 "h.vtu",
                                 "h.inp --as hexa",
                                 "k.raw --as mask"}) {
    CAPTURE(what);
    const std::string file = what.substr(0, what.find(' '));
    const std::string printed = bench.mustRun("export g.vdb " + what);
    CHECK(printed.find(file) == 0);
    const std::string bytes = bench.bytes(file);
    CHECK(bytes.size() > 100);
    bench.mustRun("export g.vdb " + what + " --threads 1 -q");
    CHECK(bench.bytes(file) == bytes);
  }
  CHECK(bench.bytes("k.raw").size() == 40 * 40 * 40);
  // Clumps of an open scan reach beyond it, and the command says so.
  CHECK(bench.mustRun("export g.vdb c.csv --as clumps").find("beyond") != std::string::npos);
  bench.mustRun("segment s.vdb closed.vdb --keep balls --boundary closed");
  CHECK(bench.mustRun("export closed.vdb c.csv --as clumps").find("beyond") == std::string::npos);
  CHECK(bench.bytes("bonds.csv").find("bond,first,second") == 0);
  CHECK(bench.bytes("cover.csv").find("grain_id,voxels") == 0);
  bench.mustRun("export g.vdb folder --as mesh");
  CHECK(bench.bytes("folder/grain_000001.stl").size() > 84);
}

TEST_CASE("cli: reduced labels of voxels below 20 nm are in the unit that is said", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 40 --count 5 --radius 6:9 --voxel-size 10nm");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("export g.vdb l.vdb --as lod");
  bench.mustRun("convert l.vdb l.nrrd");
  CHECK(bench.bytes("l.nrrd").find("space origin: (5e-06,5e-06,5e-06)") != std::string::npos);
  CHECK(bench.mustRun("export l.vdb l.ply").find("lengths in mm") != std::string::npos);
  // A mesh is in the unit of its labels, reduced or not.
  CHECK(bench.mustRun("export g.vdb m.ply --reduce 2").find("lengths in um") != std::string::npos);
}

TEST_CASE("cli: OME-Zarr is the same for any number of threads, and read back", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  for (const std::string version : {"0.4", "0.5", "0.6"}) {
    CAPTURE(version);
    const std::string options = " --ome " + version;
    CHECK(bench.mustRun("export g.vdb a.ome.zarr" + options).find("OME-Zarr " + version) !=
          std::string::npos);
    bench.mustRun("export g.vdb b.zarr --as zarr -q --threads 1" + options);
    CHECK(treeOf(bench.path("a.ome.zarr")) == treeOf(bench.path("b.zarr")));
    CHECK(treeOf(bench.path("a.ome.zarr")).size() > 5);
    bench.mustRun("convert g.vdb g.npy --grid grain -q");
    bench.mustRun("convert b.zarr/labels/grain z.npy --type int32 -q");
    CHECK(bench.bytes("z.npy") == bench.bytes("g.npy"));
    const Outcome again = bench.run("export g.vdb a.ome.zarr");
    CHECK(again.exitCode == 1);
    CHECK(again.err.find("already") != std::string::npos);
    std::filesystem::remove_all(bench.path("a.ome.zarr"));
    std::filesystem::remove_all(bench.path("b.zarr"));
  }
}

TEST_CASE("cli: exports say which places and edges they do not tell", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack p.vdb --size 40 --radius 6 --voxel-size 2x2x3um");
  bench.mustRun("segment p.vdb c.vdb --crop 3,0,5:39,39,39 -q");
  bench.mustRun("convert c.vdb r.vdb --resample 3um -q");
  const Outcome crop = bench.run("export c.vdb c.zarr"),
                lattice = bench.run("export c.vdb c.dat --as palabos"),
                resampled = bench.run("export r.vdb r.zarr");
  for (const Outcome& outcome : {crop, lattice, resampled}) CHECK(outcome.exitCode == 0);
  CHECK_THAT(crop.err, Contains("c.zarr: begins at voxel 3,0,5 of the scan, and boxes of grains"));
  CHECK_THAT(lattice.err,
             Contains("c.dat: its voxels are no cubes, and a lattice is one of cubes"));
  CHECK_THAT(lattice.err, Contains("c.dat: begins at voxel 3,0,5 of the scan"));
  CHECK_THAT(resampled.err, Contains("r.zarr: places in the tables count from voxel 0,0,0"));
}

TEST_CASE("cli: endings in upper case are the same", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  for (const auto& [lower, upper, as] : {std::tuple{"m.ply", "M.PLY", ""},
                                         {"m.stl", "M.STL", ""},
                                         {"m.glb", "M.GLB", ""},
                                         {"m.vtp", "M.VTP", " --as mesh"},
                                         {"i.vti", "I.VTI", ""},
                                         {"n.graphml", "N.GraphML", ""},
                                         {"n.vtp", "N.VTP", " --as network"},
                                         {"h.vtu", "H.VTU", ""},
                                         {"h.inp", "H.INP", ""},
                                         {"c.csv", "C.CSV", " --as clumps"},
                                         {"l.vdb", "L.VDB", " --as lod"},
                                         {"k.raw", "K.RAW", " --as mask"}}) {
    CAPTURE(upper);
    bench.mustRun(std::string("export g.vdb ") + lower + as);
    bench.mustRun(std::string("export g.vdb ") + upper + as);
    CHECK(bench.bytes(upper) == bench.bytes(lower));
  }
  bench.mustRun("export g.vdb m.obj");
  const std::string lower = bench.bytes("m.obj");  // which names its materials, m.mtl
  std::filesystem::remove(bench.path("m.obj"));
  std::filesystem::remove(bench.path("m.mtl"));
  bench.mustRun("export g.vdb m.Obj");
  CHECK(bench.bytes("m.Obj") == lower);
  CHECK(bench.run("export g.vdb O.VTP").exitCode == 2);  // mesh or network: not clear
}

TEST_CASE("cli: labels without a voxel are exported, but for their surface", "[cli]") {
  const Bench bench;
  bench.write("zero.raw", std::string(4 * 64, '\0'));
  const std::string layout = " --dims 4x4x4 --type int32";
  for (const std::string out :
       {"m.ply", "m.obj", "m.stl", "folder --as mesh", "m.vtp --as mesh", "v.vdb --as viz",
        "l.vdb --as lod", "g.vdb --as grids", "i.vti", "p.dat --as palabos", "n.vtp --as network",
        "n.graphml", "h.vtu", "h.inp", "k.raw --as mask", "z.zarr"})
    bench.mustRun("export zero.raw " + out + layout);
  const Outcome surface = bench.run("export zero.raw s.vdb --as surface" + layout);
  CHECK(surface.exitCode == 1);
  CHECK(surface.err.find("no labeled voxel") != std::string::npos);
  CHECK(bench.names().count("s.vdb") == 0);
}

TEST_CASE("cli: an export onto a full disk leaves nothing", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  RunOptions full;
  full.largestFile = 100;
  const auto before = bench.names();
  for (const std::string out : {"m.ply",
                                "m.obj",
                                "m.stl",
                                "folder --as mesh",
                                "m.vtp --as mesh",
                                "v.vdb --as viz",
                                "l.vdb --as lod",
                                "q.vdb --as grids",
                                "s2.vdb --as surface",
                                "i.vti",
                                "p.dat --as palabos",
                                "i.vti --compress",
                                "n.vtp --as network",
                                "n.graphml",
                                "n.csv --as network",
                                "c.csv --as clumps",
                                "h.vtu",
                                "h.inp",
                                "k.raw --as mask",
                                "z.ome.zarr",
                                "k.tif --as mask",
                                "k.mhd --as mask"}) {
    CAPTURE(out);
    const Outcome outcome = bench.run("export g.vdb " + out, full);
    CHECK(outcome.exitCode == 1);
    CHECK(outcome.err.find("vdb_madf: error: ") == 0);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(bench.names() == before);
  }
}

TEST_CASE("cli: a signal ends an export and leaves nothing", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 200 --count 40 --radius 18:24");
  for (const std::string out : {"m.obj", "h.inp", "z.zarr"}) {
    RunOptions interrupted;
    interrupted.signal = SIGINT;
    interrupted.interruptOn = "." + out;  // the temporary file: the work has begun
    const Outcome outcome = bench.run("export s.vdb --grid truth " + out, interrupted);
    CHECK(outcome.exitCode == 130);
    CHECK(outcome.err == "vdb_madf: error: interrupted\n");
    CHECK(bench.names() == std::set<std::string>{"s.vdb"});
  }
}

TEST_CASE("cli: a mesh keeps to its triangles and keeps all grains", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  const auto counts = [&](const std::string& options) {
    const std::string printed = bench.mustRun("export g.vdb m.ply " + options);
    std::array<int, 2> result{};
    REQUIRE(std::sscanf(printed.c_str(), "m.ply: %d grain%*[s], %*d points, %d", &result[0],
                        &result[1]) == 2);
    CHECK(bench.bytes("m.ply").find("element face " + std::to_string(result[1]) + "\n") !=
          std::string::npos);
    return result;
  };
  const auto [grains, all] = counts("");
  REQUIRE(grains > 3);
  for (const std::string smooth : {"--smooth 0", "--smooth 5"})
    for (const int budget : {all / 2, all / 5}) {
      const auto [kept, triangles] = counts(smooth + " --triangles " + std::to_string(budget));
      CHECK(kept == grains);
      CHECK(triangles <= budget);
      CHECK(triangles > budget - 20);
    }
  CHECK(counts("--triangles " + std::to_string(all)) == std::array{grains, all});
  const std::string least = bench.mustRun("export g.vdb m.ply --triangles 1");
  CHECK(least.find("m.ply: " + std::to_string(grains) + " grains") == 0);
  CHECK(least.find("(fewer would not keep all grains and contacts)") != std::string::npos);
}

TEST_CASE("cli: a mesh of some grains has these alone", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  bench.mustRun("export g.vdb all --as mesh --smooth 0");
  for (const std::string options : {"", " --triangles 500"}) {
    bench.mustRun("export g.vdb some" + options + " --as mesh --smooth 0 --select 2,1");
    CHECK(bench.bytes("some/grain_000001.stl") != "");
    CHECK(bench.bytes("some/grain_000002.stl") != "");
    if (options.empty())
      CHECK(bench.bytes("some/grain_000002.stl") == bench.bytes("all/grain_000002.stl"));
  }
  CHECK(bench.mustRun("export g.vdb some.ply --select 2").find("some.ply: 1 grain,") == 0);
}

TEST_CASE("cli: export refuses what it cannot know or do", "[cli]") {
  const Bench bench;
  makeLabels(bench);
  const auto refusal = [&](const std::string& arguments, int code, const std::string& word) {
    CAPTURE(arguments);
    const Outcome outcome = bench.run("export " + arguments);
    CHECK(outcome.exitCode == code);
    CHECK(outcome.err.find("vdb_madf: error: ") == 0);
    CHECK(outcome.err.find(word) != std::string::npos);
  };
  refusal("g.vdb x.vdb", 2, "--as");
  refusal("g.vdb x.vtp", 2, "--as");
  refusal("g.vdb x.ply --as viz", 2, ".vdb");
  refusal("g.vdb x.vdb --as picture", 2, "mesh");
  refusal("g.vdb x.vtk --as hexa", 2, ".inp");
  refusal("g.vdb x --as zarr", 2, ".zarr");
  refusal("g.vdb x.zarr --ome 0.3", 2, "ome");
  refusal("s.vdb x.zarr --grid truth --meshes --smooth 2000", 2, "smooth");
  refusal("g.vdb none/x.zarr", 1, "none/x.zarr");
  refusal("g.vdb x.ply --smooth -1", 2, "smooth");
  refusal("g.vdb x.vdb --as viz --reduce 2 --max-dim 9", 2, "max-dim");
  refusal("g.vdb g.vdb --as viz", 2, "overwrite");
  refusal("g.vdb x.ply --triangles 0", 2, "triangles");
  refusal("g.vdb x.ply --select 0", 2, "grains have the numbers 1 and more");
  refusal("g.vdb x.ply --select 3,,4", 2, "select");
  refusal("g.vdb x.ply --select 123456", 1, "123456");
  refusal("g.vdb x.inp --reduce 2", 2, "--reduce is for --as mesh, viz, lod, zarr, not hexa");
  refusal("g.vdb x.vtu --max-dim 9", 2, "--max-dim is for");
  refusal("g.vdb x.vti --smooth 3", 2, "--smooth is for");
  refusal("g.vdb x.csv --as network --apart", 2, "--apart is for --as clumps, not network");
  refusal("g.vdb x.ply --min-faces 3", 2, "--min-faces is for");
  refusal("g.vdb x.zarr --triangles 99", 2, "give --meshes, too");
  refusal("g.vdb x.vdb --as viz --select 1", 2, "--as mesh");
  refusal("g.vdb c.csv --as clumps --uncovered nan", 2, "uncovered");
  refusal("g.vdb c.csv --as clumps --uncovered 1.1", 2, "uncovered");
  refusal("g.vdb x.ply --smooth nan", 2, "smooth");
  refusal("g.vdb none/x.ply", 1, "none/x.ply");
  refusal("g.vdb none/folder --as mesh", 1, "none/folder");
  refusal("g.vdb s.vdb/folder --as mesh", 1, "s.vdb/folder");
  refusal("g.vdb /dev/full --as mesh", 1, "/dev/full");
  refusal("none.vdb x.ply", 1, "none.vdb");
  CHECK(bench.names() == std::set<std::string>{"g.vdb", "s.vdb"});
}
