// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the command says though it is no error: on stderr, unless quiet, and in JSON.

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/command_runs.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// The command succeeds with one note that says all of this.
void notes(const Bench& bench, const std::string& arguments, const std::vector<std::string>& says) {
  INFO("vdb_madf " << arguments);
  const Outcome outcome = bench.run(arguments);
  CHECK(outcome.exitCode == 0);
  CHECK(outcome.err.find("vdb_madf: note: ") == 0);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  for (const std::string& text : says) CHECK_THAT(outcome.err, vdb_madf::test::Contains(text));
  bench.mustRun(arguments + " -q");  // without a word
}

void writeGrid(const Bench& bench, const std::string& file, const openvdb::Vec3d& edges,
               double shear = 0) {
  initialize();
  const auto grid = Int32Grid::create();
  grid->denseFill(CoordBBox(Coord(0), Coord(7)), 1);
  const auto transform = openvdb::math::Transform::createLinearTransform();
  transform->preScale(edges);
  if (shear > 0) transform->preShear(shear, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  grid->setTransform(transform);
  grid->setName("grain");
  writeVdb(bench.path(file), {grid});
}

}  // namespace

TEST_CASE("cli: a place that is not taken over is said", "[cli]") {
  const Bench bench;
  bench.mustRun("generate spheres s.vdb --size 32 --count 3 --radius 4:6");
  bench.mustRun("segment s.vdb g.vdb --crop 3,0,5:28,31,31");
  bench.mustRun("export g.vdb c.zarr -q");
  for (const std::string out : {"c.mha", "c.mhd", "c.nrrd"}) {
    bench.mustRun("convert g.vdb " + out);
    notes(bench, "convert " + out + " o.vdb --labels", {out + ": begins elsewhere than at 0"});
    bench.mustRun("convert s.vdb --grid object " + out);
    bench.mustRun("convert " + out + " o.vdb");
  }
  notes(bench, "convert c.zarr o.vdb --labels --dataset labels/grain/0",
        {"c.zarr: begins elsewhere than at 0"});
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("export g.vdb w.zarr");
  bench.mustRun("convert w.zarr o.vdb --labels --dataset labels/grain/0");
}

TEST_CASE("cli: that a part of closed labels is closed is said", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.tif --size 24 --length 8");
  bench.mustRun("segment s.tif g.vdb --boundary closed");
  bench.mustRun("segment s.tif o.vdb --boundary open");
  const std::string part = " p.vdb --labels --crop 4,4,4:19,19,19";
  notes(bench, "convert g.vdb" + part, {"g.vdb: is closed, and so is the part of it"});
  bench.mustRun("convert o.vdb" + part);
  bench.mustRun("convert g.vdb p.vdb --labels --crop 0,0,0:23,23,23");
}

TEST_CASE("cli: that an image does not say closed is said", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 24 --length 8");
  bench.mustRun("segment s.vdb g.vdb --boundary open");
  for (const std::string grid : {"s.vdb --grid object ", "g.vdb --grid grain "}) {
    notes(bench, "convert " + grid + "o.tif --crop 0,0,0:9,9,9 --boundary closed",
          {"o.tif", "closed"});
    bench.mustRun("convert " + grid + "o.tif --crop 0,0,0:9,9,9");
  }
}

TEST_CASE("cli: cubes in the place of a file's proportions are said", "[cli]") {
  const Bench bench;
  bench.write("u.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nspacings: 1 1 3\n"
              "encoding: raw\n\n" +
                  std::string(32, '\1') + std::string(32, '\0'));
  bench.mustRun("convert u.nrrd u.vdb");
  bench.mustRun("convert u.nrrd l.vdb --labels");
  const std::vector<std::string> says{"as 1 to 1 to 3; 10 um was given"};
  notes(bench, "segment u.nrrd o.vdb --phase 1 --voxel-size 10um", says);
  notes(bench, "segment u.vdb o.vdb --voxel-size 10um", says);
  notes(bench, "measure l.vdb t --voxel-size 10um", says);
  bench.mustRun("measure l.vdb t --voxel-size 10x10x30um");
  bench.mustRun("segment u.vdb s.vdb --voxel-size 2x2x6um");
  bench.mustRun("segment u.vdb s.vdb");
  notes(bench, "measure s.vdb t --voxel-size 10um", {"s.vdb: was segmented in voxels of other"});
}

TEST_CASE("cli: a voxel size that contradicts the file is said", "[cli]") {
  const Bench bench;
  bench.mustRun("generate snow a.tif --size 24 --length 8 --voxel-size 10um");
  bench.mustRun("segment a.tif g.vdb --voxel-size 10.05um");
  const std::vector<std::string> says{"10 um", "8.5 mm", "850 times as long"};
  for (const std::string arguments :
       {"segment a.tif o.vdb", "segment a.tif --dry-run", "convert a.tif o.npy",
        "convert a.tif o.vdb", "export a.tif o.ply"}) {
    std::vector<std::string> all = says;
    all.push_back("a.tif");
    notes(bench, arguments + std::string(" --voxel-size 8.5mm"), all);
  }
  notes(bench, "convert g.vdb o.vdb --voxel-size 1um",
        {"g.vdb", "10.05 um", "10.05 times as short"});
  notes(bench, "measure g.vdb tables --voxel-size 11um", {"g.vdb", "10.05 um", "11 um"});

  const std::string options = " --voxel-size 8.5mm --json j.json -q";
  bench.mustRun("segment a.tif o.vdb" + options);
  CHECK(Json::parse(bench.bytes("j.json")).at("notes").size() == 1);
  bench.mustRun("segment a.tif o.vdb --dry-run" + options);
  CHECK(Json::parse(bench.bytes("j.json")).at("notes").size() == 1);
  bench.mustRun("segment a.tif o.vdb --json j.json");
  CHECK(Json::parse(bench.bytes("j.json")).count("notes") == 0);
}

TEST_CASE("cli: a slice that is missing is said", "[cli]") {
  const Bench bench;
  std::filesystem::create_directory(bench.path("scan"));
  bench.write("s.raw", std::string(32, '\0') + std::string(32, '\1'));
  for (const std::string z : {"1", "2", "3", "5", "6"})
    bench.mustRun("convert s.raw scan/s" + z + ".tif --dims 8x8x1 --type uint8");
  const std::vector<std::string> says{"scan: 1 slice missing between s3.tif and s5.tif"};
  notes(bench, "info scan", says);
  notes(bench, "convert scan o.vdb", says);
  notes(bench, "segment scan o.vdb", says);
  bench.mustRun("info scan -q --json j.json");
  CHECK(Json::parse(bench.bytes("j.json")).at("notes").size() == 1);
  bench.mustRun("convert s.raw scan/s4.tif --dims 8x8x1 --type uint8");
  bench.mustRun("info scan");
}

TEST_CASE("cli: that labels become a mask is said", "[cli]") {
  const Bench bench;
  std::string labels(4, '\0');
  for (const char label : {7, 9, 1, 2, 3}) labels += std::string(4, label);
  bench.write("labels.raw", labels);
  bench.write("mask.raw", std::string(12, '\0') + std::string(12, '\7'));
  const std::string layout = " --dims 24x1x1 --type uint8 ";
  notes(bench, "convert labels.raw o.vdb" + layout, {"labels.raw", "one mask", "--labels"});
  notes(bench, "segment labels.raw o.vdb" + layout, {"labels.raw", "one mask", "--labels"});
  bench.mustRun("convert mask.raw o.vdb" + layout);
  bench.mustRun("convert labels.raw o.vdb --phase 7" + layout);
  bench.mustRun("convert labels.raw o.npy" + layout);
  bench.mustRun("measure labels.raw tables" + layout);
}

TEST_CASE("cli: a VDB of sheared voxels is refused by all but info", "[cli]") {
  const Bench bench;
  writeGrid(bench, "flat.vdb", {1, 1, 2}, 0.3);
  writeGrid(bench, "cubic.vdb", {1, 1, 1});
  const auto before = bench.names();
  for (const std::string arguments :
       {"segment flat.vdb o.vdb", "segment flat.vdb o.vdb --voxel-size 5um",
        "measure flat.vdb tables", "export flat.vdb o.ply", "export flat.vdb o.vti",
        "convert flat.vdb o.mhd", "convert flat.vdb o.vdb", "render flat.vdb o.png",
        "sweep flat.vdb o.csv", "remerge flat.vdb o.vdb", "compare flat.vdb cubic.vdb",
        "compare cubic.vdb flat.vdb"}) {
    CAPTURE(arguments);
    const Outcome outcome = bench.run(arguments);
    CHECK(outcome.exitCode == 1);
    CHECK_THAT(outcome.err,
               vdb_madf::test::Contains("flat.vdb") && vdb_madf::test::Contains("turned, sheared"));
    CHECK(bench.names() == before);
  }
  notes(bench, "info flat.vdb", {"flat.vdb", "'grain'", "not along the axes"});
}

TEST_CASE("cli: unequal voxels keep their shape, and what needs cubes says so", "[cli]") {
  const Bench bench;
  writeGrid(bench, "plain.vdb", {1, 1, 1});
  bench.mustRun("convert plain.vdb flat.vdb --voxel-size 0.5x0.7x1.2um");
  bench.mustRun("convert plain.vdb cubes.vdb --voxel-size 0.5um");
  for (const std::string file : {"flat.vdb", "flat.mhd", "flat.nrrd", "flat.tif"}) {
    if (file != "flat.vdb") bench.mustRun("convert flat.vdb " + file);
    const std::string said = bench.mustRun("info " + file);
    CHECK_THAT(said, vdb_madf::test::Contains("voxel_size_mm: [0.0005,0.0007,0.0012]"));
  }
  for (const std::string arguments :
       {"convert flat.mhd o.vdb --labels", "render flat.vdb o.png", "export flat.vdb o.ply",
        "export flat.vdb o.vti", "export flat.vdb o.inp", "export flat.vdb o.vdb --as viz",
        "export flat.vdb o.vdb --as lod", "compare flat.vdb flat.tif", "info flat.vdb",
        "measure flat.vdb t", "export flat.vdb n.graphml", "export flat.vdb c.csv --as clumps",
        "segment flat.vdb s.vdb --tables t"})
    bench.mustRun(arguments);
  for (const std::string arguments :
       {"export flat.vdb s.vdb --as surface", "export flat.vdb s.vdb --as grids"}) {
    CAPTURE(arguments);
    const auto before = bench.names();
    const Outcome outcome = bench.run(arguments);
    CHECK(outcome.exitCode == 1);
    CHECK_THAT(outcome.err, vdb_madf::test::Contains("flat.vdb") &&
                                vdb_madf::test::Contains("needs cubic voxels") &&
                                vdb_madf::test::Contains("(convert --resample)"));
    CHECK(bench.names() == before);
  }
  for (const std::string arguments :
       {"convert flat.vdb o.npy", "convert flat.mhd o.raw", "export flat.vdb o.raw --as mask"})
    notes(bench, arguments, {"does not say that its voxels are no cubes", "--voxel-size"});
  // Of an unknown unit: the shape is kept, and a size may be given.
  bench.write("flat.nrrd",
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 3\n"
              "encoding: raw\n\n" +
                  std::string("\1\1\1\1\1\0\0\0", 8));
  CHECK_THAT(bench.mustRun("info flat.nrrd"),
             vdb_madf::test::Contains("voxel_size_units: [1.0,1.0,3.0]"));
  bench.mustRun("convert flat.nrrd unknown.vdb");
  const std::string unknown = bench.mustRun("info unknown.vdb");
  CHECK_THAT(unknown, vdb_madf::test::Contains("voxel_size_units: [1.0,1.0,3.0]"));
  CHECK(unknown.find("voxel_size_mm") == std::string::npos);
  bench.mustRun("convert flat.nrrd known.vdb --voxel-size 1x1x3um");
  CHECK_THAT(bench.mustRun("info known.vdb"),
             vdb_madf::test::Contains("voxel_size_mm: [0.001,0.001,0.003]"));
  CHECK_THAT(bench.mustRun("measure flat.nrrd t"), vdb_madf::test::Contains("in shortest edges"));
  notes(bench, "convert flat.nrrd o.tif", {"does not say that its voxels are no cubes"});
  notes(bench, "convert unknown.vdb u.mhd", {"does not say that its voxels are no cubes"});
  const Outcome other = bench.run("compare flat.vdb cubes.vdb");
  CHECK(other.exitCode == 1);
  CHECK_THAT(other.err, vdb_madf::test::Contains("1, 0.7143, 0.4167 times as long"));
  notes(bench, "convert flat.vdb o.vdb --voxel-size 0.5x0.7x1.3um",
        {"0.5 x 0.7 x 1.2 um", "0.5 x 0.7 x 1.3 um"});
}

TEST_CASE("cli: an image that does not say its boundary is told", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack s.tif --size 24 --radius 5");
  bench.mustRun("segment s.tif open.vdb");
  bench.mustRun("segment s.tif closed.vdb --boundary closed --keep manifold");
  bench.mustRun("convert open.vdb o.mhd");
  for (const std::string run :
       {"convert closed.vdb o.tif", "export closed.vdb o.raw --as mask",
        "segment s.tif o.nrrd --boundary closed", "remerge closed.vdb o.mha"})
    notes(bench, run, {": does not say that the boundary is closed", "--boundary closed"});
  const Outcome zarr = bench.run("export closed.vdb o.zarr");
  CHECK_THAT(zarr.err, vdb_madf::test::Contains("does not say that the boundary is closed"));
  for (const std::string run : {"convert closed.vdb o.vdb", "export closed.vdb o.vti"})
    bench.mustRun(run);
}

TEST_CASE("cli: grains that vanish in reduced labels are said", "[cli]") {
  const Bench bench;
  initialize();
  const auto grid = Int32Grid::create();
  grid->denseFill(CoordBBox(Coord(0), Coord(7, 7, 3)), 1);
  grid->denseFill(CoordBBox(Coord(5, 5, 6), Coord(5, 5, 6)), 2);
  setDomain(*grid, CoordBBox(Coord(0), Coord(7)));
  grid->setName("grain");
  writeVdb(bench.path("g.vdb"), {grid});
  for (const std::string out : {"m.ply --reduce 2", "l.vdb --as lod", "m.ply --max-dim 4"})
    notes(bench, "export g.vdb " + out, {"1 of 2 grains are too small to be seen in reduced"});
  bench.mustRun("export g.vdb m.ply");
}

TEST_CASE("cli: values that are no finite numbers are counted", "[cli]") {
  const Bench bench;
  std::vector<float> values(64, 1);
  values[0] = values[10] = values[11] = NAN;
  values[20] = INFINITY;
  bench.write("a.raw", {reinterpret_cast<const char*>(values.data()), 4 * values.size()});
  const std::string layout = " --dims 4x4x4 --type float32";
  const std::string said = bench.run("segment a.raw s.vdb --threshold 2" + layout).err;
  CHECK_THAT(said, vdb_madf::test::Contains("a.raw: has 3 voxels without a number (NaN), taken for "
                                            "scanned background: if they are around a round"));
  CHECK_THAT(said, vdb_madf::test::Contains("a.raw: has 1 voxel of infinite value"));
}

TEST_CASE("cli: a slice with a closed boundary is said", "[cli]") {
  const Bench bench;
  bench.write("a.raw", std::string("\1\0\1\1", 4));
  const std::string segment = "segment a.raw s.vdb --dims 2x2x1 --type uint8 --boundary ";
  notes(bench, segment + "closed", {"a.raw: one voxel along z, and a closed boundary has"});
  bench.mustRun(segment + "open");
}
