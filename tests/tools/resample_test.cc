// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// `convert --resample`, run as a user runs it.

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

/// Of 3 x 1 x 2 voxels, in cubes of half their height.
const std::string kRaw = " --dims 3x1x2 --type uint8 --voxel-size 1x1x2um --resample 1um ";

std::string twiceAlongZ(const std::string& samples) {
  const std::string low = samples.substr(0, 3), high = samples.substr(3);
  return low + low + high + high;
}

}  // namespace

TEST_CASE("resample: labels keep their values, masks their volume, gray images their slope",
          "[resample]") {
  const Bench bench;
  const std::string values{5, 90, 0, 9, 50, 7};
  bench.write("v.raw", values);
  bench.mustRun("convert v.raw gray.raw --dims 3x1x2 --type uint8");
  bench.mustRun("convert v.raw o.nrrd" + kRaw);
  bench.mustRun("convert o.nrrd o.raw");
  CHECK(bench.bytes("o.raw") == std::string{5, 90, 0, 6, 80, 2, 8, 60, 5, 9, 50, 7});
  // The corner stays: the first cube lies half a micrometer below the first voxel.
  CHECK_THAT(bench.bytes("o.nrrd"), Contains("space origin: (0,0,-5e-04)"));

  for (const std::string ending : {"vdb", "npy"}) {
    bench.mustRun("convert v.raw l." + ending + " -q --labels" + kRaw);
    bench.mustRun("convert l." + ending + " l.raw -q --type uint8");
    CHECK(bench.bytes("l.raw") == twiceAlongZ(values));
    bench.mustRun("convert v.raw m." + ending + " -q --threshold 9" + kRaw);
    bench.mustRun("convert m." + ending + " m.raw -q --type uint8");
    CHECK(bench.bytes("m.raw") == twiceAlongZ({0, 1, 0, 1, 1, 0}));
  }
  const std::string size = " --voxel-size 1x1x2um --resample 2um";
  // Half of each cube is outside along y, so that all that is left has to be object.
  bench.mustRun("convert v.raw m.vdb --threshold 9 --dims 3x1x2 --type uint8" + size);
  CHECK_THAT(bench.run("convert m.vdb m.raw --type uint8").err,
             Contains("m.raw: the center of its first voxel is at 0.0005,0.0005,0 mm"));
  CHECK(bench.bytes("m.raw") == std::string{0, 0, 1, 0});
  bench.mustRun("convert v.raw l.raw -q --labels --type uint8 --dims 3x1x2" + size);
}

TEST_CASE("resample: grains of unequal voxels become grains of cubes", "[resample]") {
  const Bench bench;
  bench.mustRun("generate snow s.npy --size 40 --length 12");
  bench.run(
      "segment s.npy g.vdb --voxel-size 5x5x7um --roi cylinder:z:19.5,19.5:18 --keep manifold");
  const std::string said = bench.mustRun("convert g.vdb c.vdb --resample 5um");
  CHECK_THAT(said, Contains("c.vdb: grid 'grain', "));
  const Json info = infoOf(bench, "c.vdb");
  CHECK(gridsOf(info) == std::set<std::string>{"grain", "region"});
  const Json cubes = gridOf(info, "grain"), voxels = gridOf(infoOf(bench, "g.vdb"), "grain");
  CHECK(cubes.at("voxel_size_mm") == 0.005);
  CHECK(cubes.at("metadata").at("madf_domain_max") == Json({35, 35, 55}));
  for (const char* count : {"region_voxels", "active_voxels"})
    CHECK(cubes.at(count).get<double>() / voxels.at(count).get<double>() ==
          Approx(7. / 5).epsilon(0.01));
  const Outcome measured = bench.run("measure c.vdb tables");
  CHECK(measured.exitCode == 0);
  CHECK_THAT(measured.err, Contains("c.vdb: places in the tables count from voxel 0,0,0, whose "
                                    "center is at 0.01,0.01,-0.001 mm: meshes"));
  bench.mustRun("export c.vdb surface.vdb --as surface");
  bench.mustRun("convert g.vdb d.vdb --resample 5um --threads 1");
  CHECK(bench.bytes("d.vdb") == bench.bytes("c.vdb"));
  // Of a selection, or of a mask, the object.
  bench.mustRun("convert g.vdb m.vdb --range 1:1e9 --resample 5um");
  CHECK(gridsOf(infoOf(bench, "m.vdb")) == std::set<std::string>{"object", "region"});
  bench.mustRun("convert m.vdb n.vdb --resample 10um");
  CHECK(gridOf(infoOf(bench, "n.vdb"), "object").at("value_type") == "bool");
}

TEST_CASE("resample: what makes no sense is refused in a line", "[resample]") {
  const Bench bench;
  bench.mustRun("generate snow s.vdb --size 24 --length 12 --voxel-size 5um");
  bench.mustRun("convert s.vdb s.npy");
  bench.mustRun("convert s.npy gray.npy --smooth 2");
  const std::string convert = "convert s.vdb o.vdb --resample ";
  for (const std::string size : {"10", "0um", "-1um", "um", "1x2um", "1x1x2um", "nan"})
    refuses(bench, kWrongUsage, convert + size, {"--resample " + size});
  refuses(bench, kFailed, convert + "10mm", {"s.vdb: ", "256 times"});
  refuses(bench, kFailed, convert + "500um", {"s.vdb: ", "half as thick"});
  refuses(bench, kFailed, convert + "0.02um", {"s.vdb: ", "4294966784 voxels"});
  refuses(bench, kFailed, "convert s.npy o.vdb --resample 5um", {"s.npy", "--voxel-size"});
  refuses(bench, kFailed, "convert gray.npy o.npy --resample 5um", {"gray.npy", "--voxel-size"});
  refuses(bench, kFailed, "convert s.npy o.npy --resample 5um --voxel-size 9um",
          {"s.npy: has a few values", "--phase", "--labels"});
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("export g.vdb surface.vdb --as viz");
  refuses(bench, kFailed, "convert surface.vdb o.vdb --resample 10um --grid density",
          {"surface.vdb: grid 'density' holds float", "--threshold"});
  bench.mustRun("convert gray.npy o.tif --resample 5um --voxel-size 9um");
  std::string labels(4, '\0');
  for (const char label : {7, 9, 1, 2, 3}) labels += std::string(4, label);
  bench.write("labels.raw", labels);
  const Outcome mixed = bench.run(
      "convert labels.raw o.raw --dims 24x1x1 --type uint8 --voxel-size 1um --resample 2um");
  CHECK(mixed.exitCode == 0);
  CHECK_THAT(mixed.err, Contains("labels.raw") && Contains("--labels keeps them"));
}
