// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Regions of a scan, round cores above all, run as a user runs them.

#include <cstdint>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

constexpr int kSide = 48;
constexpr double kMiddle = 23.5, kRadius = 20;

bool isInCore(int x, int y) {
  return (x - kMiddle) * (x - kMiddle) + (y - kMiddle) * (y - kMiddle) <= kRadius * kRadius;
}

/// A snow sample of 48^3 voxels, `full.npy`, and the core that a round scan would have of it,
/// `core.npy`, beside the mask of its field of view, `view.npy`, and one without end, `box.npy`.
struct Core {
  int64_t object = 0, inside = 0,
          outside = 0;  ///< voxels of ice in the core, voxels of it, ice beyond

  explicit Core(const Bench& bench) {
    bench.mustRun("generate snow full.npy --size 48 --length 14");
    bench.mustRun("convert full.npy full.raw");
    const std::string full = bench.bytes("full.raw");
    std::string core = full, view = full, box(full.size(), '\1');
    for (size_t i = 0; i < full.size(); ++i) {
      const bool in = isInCore(int(i % kSide), int(i / kSide % kSide));
      view[i] = in;
      if (!in) core[i] = 0;
      inside += in;
      object += in && full[i] != 0;
      outside += !in && full[i] != 0;
    }
    for (const auto& [name, bytes] : {std::pair("core", &core), {"view", &view}, {"box", &box}}) {
      bench.write("x.raw", *bytes);
      bench.mustRun("convert x.raw " + std::string(name) + ".npy --dims 48x48x48 --type uint8");
    }
  }
};

std::string note(const std::string& text) {
  return "vdb_madf: note: " + text + "\n";
}

/// Runs it; what it prints on stderr must be these notes.
Json segmented(const Bench& bench, const std::string& arguments, const std::string& notes) {
  const Outcome outcome = bench.run("segment " + arguments + " --json s.json");
  INFO(arguments);
  CHECK(outcome.err == notes);
  REQUIRE(outcome.exitCode == 0);
  return Json::parse(bench.bytes("s.json"));
}

const std::string kFitted = note(
    "core.npy: the region is a cylinder along z around x 23.5, y 23.5, to which a radius of 19.97 "
    "voxels was fitted");

}  // namespace

TEST_CASE("region: a round core has the porosity of its cylinder", "[region]") {
  const Bench bench;
  const Core core(bench);
  const double porosity = 1 - double(core.object) / double(core.inside);
  const Json plain = segmented(bench, "core.npy p.vdb", "");
  CHECK(plain.at("porosity").get<double>() > porosity + 0.1);
  CHECK(plain.count("region_voxels") == 0);
  const std::string leftOut = note("full.npy: outside of the region, " +
                                   std::to_string(core.outside) + " object voxels left out");
  const std::pair<std::string, std::string> cases[] = {
      {"core.npy g.vdb --roi cylinder", kFitted},
      {"full.npy g.vdb --roi view.npy", leftOut},
      {"full.npy g.vdb --roi cylinder:z:23.5,23.5:20", leftOut},
      {"full.npy g.vdb --roi cylinder:Z::20", leftOut}};
  std::string labels;
  for (const auto& [arguments, notes] : cases) {
    const Json json = segmented(bench, arguments, notes);
    CHECK(json.at("object_voxels") == core.object);
    CHECK(json.at("region_voxels") == core.inside);
    CHECK(json.at("porosity").get<double>() == Approx(porosity));
    CHECK(json.at("boundary") == "open");
    bench.mustRun("convert g.vdb g.raw --grid grain -q");
    if (labels.empty()) labels = bench.bytes("g.raw");
    CHECK(bench.bytes("g.raw") == labels);
  }
  const std::string printed = bench.run("segment core.npy g.vdb --roi cylinder").out;
  CHECK_THAT(printed, Contains("region           " + std::to_string(core.inside) + " of 76800 "));
}

TEST_CASE("region: one that is the whole scan changes no byte", "[region]") {
  const Bench bench;
  const Core core(bench);
  bench.mustRun("segment full.npy a.vdb --keep manifold");
  for (const std::string region : {"--roi box.npy", "--roi cylinder:y::99", "--crop 0,0,0:47,47,47",
                                   "--crop -5,-5,-5:99,99,99 --roi box.npy"}) {
    CAPTURE(region);
    bench.mustRun("segment full.npy b.vdb --keep manifold -q " + region);
    CHECK(bench.bytes("a.vdb") == bench.bytes("b.vdb"));
  }
}

TEST_CASE("region: a crop is the cropped volume at its old coordinates", "[region]") {
  const Bench bench;
  const Core core(bench);
  bench.mustRun("segment full.npy g.vdb --crop 8,3,10:40,40,33");
  bench.mustRun("convert g.vdb g.raw -q");
  const std::string full = bench.bytes("full.raw");
  std::string part;
  for (int z = 10; z <= 33; ++z)
    for (int y = 3; y <= 40; ++y) part += full.substr(size_t((z * kSide + y) * kSide + 8), 33);
  bench.write("part.raw", part);
  bench.mustRun("segment part.raw wanted.raw --dims 33x38x24 --type uint8");
  CHECK(bench.bytes("g.raw") == bench.bytes("wanted.raw"));
  const Json metadata = gridOf(infoOf(bench, "g.vdb"), "grain").at("metadata");
  CHECK(metadata.at("madf_domain_min") == Json({8, 3, 10}));
  CHECK(metadata.at("madf_domain_max") == Json({40, 40, 33}));
  // The same of a VDB, and by way of a mask.
  bench.mustRun("convert full.npy full.vdb");
  bench.mustRun("convert full.vdb part.vdb --crop 8,3,10:40,40,33");
  bench.mustRun("segment part.vdb h.raw -q");
  CHECK(bench.bytes("h.raw") == bench.bytes("wanted.raw"));
}

TEST_CASE("region: all verbs keep it", "[region]") {
  const Bench bench;
  const Core core(bench);
  const std::string voxels = std::to_string(core.inside);
  segmented(bench, "core.npy g.vdb --keep manifold --roi cylinder", kFitted);
  const auto regionOf = [&](const std::string& file) {
    const Json info = infoOf(bench, file);
    CHECK(gridOf(info, "region").at("value_type") == "bool");
    Json inside = nullptr;
    for (const Json& grid : info.at("grids"))
      if (grid.at("name") != "region") inside = grid.at("region_voxels");
    return inside;
  };
  CHECK(regionOf("g.vdb") == core.inside);
  CHECK_THAT(bench.mustRun("info g.vdb"),
             Contains("domain: region, " + voxels + " of 76800 voxels of the box\n"));
  // remerge, to and fro.
  bench.mustRun("remerge g.vdb r.vdb --merge both --theta -0.5");
  CHECK(regionOf("r.vdb") == core.inside);
  bench.mustRun("remerge r.vdb s.vdb");
  CHECK(bench.bytes("s.vdb") == bench.bytes("g.vdb"));
  // The joins of kept manifolds know what reaches out of it.
  segmented(bench, "core.npy g.slabs --keep manifold --roi cylinder", kFitted);
  bench.mustRun("hierarchy g.vdb joins.csv");
  bench.mustRun("hierarchy g.slabs joins_of_slabs.csv");
  CHECK(bench.bytes("joins.csv") == bench.bytes("joins_of_slabs.csv"));
  refuses(bench, kWrongUsage, "hierarchy g.vdb n.csv --levels nan", {"--levels nan"});
  bench.mustRun("measure g.vdb stable --stability");
  bench.mustRun("remerge g.vdb r.vdb --strictness auto");
  CHECK(regionOf("r.vdb") == core.inside);
  // convert: copies have it, images its box; a mask has it, too.
  bench.mustRun("convert g.vdb c.vdb");
  CHECK(bench.bytes("c.vdb") == bench.bytes("g.vdb"));
  bench.mustRun("convert g.vdb c.vdb --grid grain");
  CHECK(gridsOf(infoOf(bench, "c.vdb")) == std::set<std::string>{"grain", "region"});
  CHECK_THAT(bench.run("convert g.vdb c.npy").out, Contains("grid 'grain', 40x40x48 voxels"));
  const Outcome written = bench.run("convert g.vdb v.npy --grid region");
  CHECK_THAT(written.out, Contains("40x40x48 voxels"));
  CHECK(written.err ==
        note("v.npy: begins at voxel 4,4,0 of the scan, and where it is read its first one is "
             "0,0,0 (a .vdb keeps the place)"));
  bench.run("convert core.npy mask.vdb --roi cylinder -q");
  CHECK(regionOf("mask.vdb") == core.inside);
  bench.mustRun("segment mask.vdb m.vdb --keep manifold");
  CHECK(regionOf("m.vdb") == core.inside);
  bench.mustRun("convert m.vdb a.raw --grid grain -q");
  bench.mustRun("convert g.vdb b.raw --grid grain -q");
  CHECK(bench.bytes("a.raw") == bench.bytes("b.raw"));
  // Inverted, it is the pores of the region.
  bench.mustRun("segment mask.vdb pores.vdb --invert --json s.json");
  CHECK(Json::parse(bench.bytes("s.json")).at("object_voxels") == core.inside - core.object);
  // Another domain takes its place.
  for (const std::string verb :
       {"convert g.vdb box.vdb", "measure g.vdb tables", "measure g.slabs tables",
        "convert g.vdb box.npy --grid grain", "segment mask.vdb box.vdb"}) {
    CAPTURE(verb);
    const Outcome boxed = bench.run(verb + " --domain 0,0,0:47,47,47");
    CHECK(boxed.exitCode == 0);
    const std::string taken = ": a domain was given and takes the place of the file's region";
    CHECK_THAT(boxed.err, Contains(taken));
    CHECK(boxed.err.find(taken) == boxed.err.rfind(taken));
  }
  bench.run("convert g.vdb box.vdb --domain 0,0,0:47,47,47");
  CHECK(gridsOf(infoOf(bench, "box.vdb")) == std::set<std::string>{"grain", "manifold"});
  CHECK_THAT(bench.run("compare g.vdb box.vdb").err,
             Contains("domains differ: [4, 4, 0] to [43, 43, 47] (region, " + voxels));
  bench.mustRun("compare g.vdb r.vdb");
  bench.mustRun("render g.vdb g.png --size 64");
  bench.mustRun("export g.vdb g.ply");
  // Reduced, the region is so, too.
  bench.mustRun("export g.vdb small.vdb --as lod --reduce 2 -q");
  CHECK(regionOf("small.vdb").get<double>() == Approx(double(core.inside) / 8).epsilon(0.05));
  CHECK_THAT(bench.run("sweep core.npy s.csv --strictness 9:11:1 --roi cylinder").out,
             Contains("3 rows"));
}

TEST_CASE("region: a gray scan of a round core that is taken for a box is told", "[region]") {
  const Bench bench;
  std::string core;
  uint32_t state = 1;
  for (int i = 0; i < kSide * kSide * 8; ++i) {
    state = state * 1664525 + 1013904223;
    const bool inside = isInCore(i % kSide, i / kSide % kSide);
    core += char(inside ? (i / 6 % 2 ? 120 : 60) + int(state >> 28) : 0);
  }
  bench.write("x.raw", core);
  bench.mustRun("convert x.raw core.npy --dims 48x48x8 --type uint8");
  const std::string said = "core.npy: the corners of all slices have the value 0";
  for (const std::string verb : {"convert core.npy o.vdb", "segment core.npy o.vdb",
                                 "segment core.npy o.slabs", "sweep core.npy o.csv"}) {
    CAPTURE(verb);
    const Outcome outcome = bench.run(verb + " --threshold 100");
    CHECK(outcome.exitCode == 0);
    CHECK_THAT(outcome.err, Contains(said) && Contains("(--roi cylinder)"));
    CHECK(outcome.err.find(said) == outcome.err.rfind(said));
    CHECK_THAT(bench.run(verb + " --threshold 100 --roi cylinder").err, !Contains(said));
  }
  CHECK_THAT(bench.run("segment core.npy o.vdb --threshold otsu").err,
             Contains("(--roi cylinder, or --threshold VALUE)"));
}

TEST_CASE("region: labels of another program are cut to it", "[region]") {
  const Bench bench;
  const Core core(bench);
  bench.mustRun("segment full.npy g.npy");
  const Outcome outcome = bench.run("convert g.npy l.vdb --labels --roi view.npy");
  CHECK(outcome.exitCode == 0);
  CHECK(outcome.err == note("g.npy: outside of the region, " + std::to_string(core.outside) +
                            " labeled voxels left out"));
  CHECK_THAT(outcome.out, Contains(std::to_string(core.object) + " labeled voxels"));
  CHECK(gridOf(infoOf(bench, "l.vdb"), "grain").at("region_voxels") == core.inside);
  bench.mustRun("measure l.vdb tables");
  // To an image, too.
  bench.mustRun("convert g.npy part.npy --labels --crop 5,6,7:20,30,40 -q");
  bench.mustRun("convert g.npy part.vdb --labels --crop 5,6,7:20,30,40");
  bench.mustRun("convert part.vdb same.npy -q");
  CHECK(bench.bytes("part.npy") == bench.bytes("same.npy"));
  CHECK(gridOf(infoOf(bench, "part.vdb"), "grain").at("metadata").at("madf_domain_min") ==
        Json({5, 6, 7}));
}

TEST_CASE("region: it makes no mask of labels, and chooses no other grid", "[region]") {
  const Bench bench;
  bench.mustRun("generate sintered s.vdb --size 32 --count 6 --radius 5:9");
  bench.mustRun("segment s.vdb g.slabs --grid object --slab-height 16 -q");
  bench.mustRun("segment s.vdb keep.vdb --grid object --keep distance,balls");
  bench.mustRun("convert g.slabs full.npy");
  bench.mustRun("convert full.npy wanted.npy --labels --crop 2,3,4:27,28,29 -q");
  const std::string wanted = bench.bytes("wanted.npy");
  const std::string crop = " --crop 2,3,4:27,28,29";
  for (const std::string in : {"g.slabs", "keep.vdb", "keep.vdb --grid grain", "full.npy"}) {
    const std::string said = bench.run("convert " + in + " o.npy" + crop).out;
    CHECK_THAT(said, Contains("grid 'grain', 26x26x26 voxels of type int32"));
    CHECK(bench.bytes("o.npy") == wanted);
  }
  CHECK_THAT(bench.mustRun("convert keep.vdb o.vdb" + crop), Contains("o.vdb: grid 'grain'"));
  const Json grid = gridOf(infoOf(bench, "o.vdb"), "grain");
  CHECK(grid.at("metadata").at("madf_object_voxels") == grid.at("active_voxels"));
  CHECK(grid.at("metadata").count("madf_critical_points") == 0);
  bench.mustRun("convert o.vdb o.npy -q");
  CHECK(bench.bytes("o.npy") == wanted);
  bench.mustRun("convert s.vdb o.npy -q" + crop);  // its grid 'truth'
  CHECK(infoOf(bench, "o.npy").at("type") == "int32");
  // Masks stay masks, and a selection makes one.
  for (const std::string in : {"s.vdb --grid object", "g.slabs --threshold 1"}) {
    bench.mustRun("convert " + in + " o.npy -q" + crop);
    CHECK(infoOf(bench, "o.npy").at("type") == "uint8");
  }
  bench.mustRun("export g.slabs fog.vdb --as viz");
  refuses(bench, kFailed, "convert fog.vdb o.npy --grid density --crop 0,0,0:9,9,9",
          {"fog.vdb: grid 'density' holds float values", "--roi and --crop take masks and labels"});
}

TEST_CASE("region: what does not hold it says so", "[region]") {
  const Bench bench;
  bench.mustRun("generate pack p.tif --size 32 --radius 5");
  bench.mustRun("segment p.tif r.vdb --roi cylinder:z::14 -q");
  bench.mustRun("segment p.tif r.slabs --roi cylinder:z::14 -q");
  for (const std::string run :
       {"export r.vdb o.npy --as mask", "export r.slabs o.npy --as mask", "export r.vdb o.vti",
        "export r.vdb o.zarr", "convert r.vdb o.npy", "convert r.slabs o.npy"}) {
    const std::string out = run.substr(run.find(" o.") + 1, 6);
    const Outcome outcome = bench.run(run);
    CAPTURE(run);
    CHECK(outcome.exitCode == 0);
    CHECK_THAT(outcome.err,
               Contains(note(out.substr(0, out.find(' ')) +
                             ": does not say where the region ends: outside of it there is 0, as "
                             "in pores (a .vdb says it)")));
  }
  const Outcome lattice = bench.run("export r.vdb o.dat --as palabos");
  CHECK_THAT(lattice.out,
             Contains("2 = inside, outside of the region as in grains, 28x28x32 voxels"));
  CHECK_THAT(lattice.err, Contains("o.dat: begins at voxel 2,2,0 of the scan"));
  bench.mustRun("convert r.vdb o.vdb");
}

TEST_CASE("region: a crop beyond the scan and a mask of other voxels are said", "[region]") {
  const Bench bench;
  const Core core(bench);
  const std::string segment = "segment core.npy out.vdb ";
  const std::string beyond =
      "reaches beyond the scan, which goes from 0 to 47 along x, 0 to 47 along z";
  CHECK_THAT(bench.run(segment + "--crop 8,0,0:48,47,48").err,
             Contains("core.npy: the crop " + beyond));
  bench.mustRun(segment + "--crop 8,0,0:47,47,47");
  bench.mustRun("convert view.npy view.vdb --voxel-size 9um");
  CHECK_THAT(bench.run(segment + "--roi view.vdb --voxel-size 8um").err,
             Contains("view.vdb: has voxels of 9 um, and core.npy of 8 um"));
  bench.mustRun(segment + "--roi view.vdb --voxel-size 9um");
  bench.mustRun(segment + "--roi view.vdb");
  // Labels that are given voxels of other proportions stay as they are.
  CHECK_THAT(bench.run("convert out.vdb other.vdb --voxel-size 1x1x2um").err,
             Contains("out.vdb: was segmented in voxels of other proportions"));
  CHECK(bench.run("convert out.vdb other.vdb --voxel-size 2um").err.find("proportions") ==
        std::string::npos);
}

TEST_CASE("region: a domain beyond the scan is said", "[region]") {
  const Bench bench;
  bench.mustRun("generate pack p.tif --size 24 --radius 5");
  bench.mustRun("segment p.tif g.vdb -q");
  bench.mustRun("segment p.tif g.slabs -q");
  bench.mustRun("convert g.vdb g.npy -q");
  const std::string domain = " --domain 0,0,0:24,23,24", fits = " --domain 0,0,0:23,22,23";
  for (const std::string verb :
       {"segment p.tif o.vdb", "segment p.tif o.slabs", "segment p.tif o.vdb --crop 0,0,0:9,9,9",
        "sweep p.tif s.csv", "measure g.vdb t", "measure g.npy t", "measure g.slabs t",
        "convert g.vdb o.vdb", "verify g.vdb p.tif"}) {
    CAPTURE(verb);
    const std::string said = bench.run(verb + domain).err;
    CHECK_THAT(said, Contains(": the domain reaches beyond the scan, which goes from 0 to 23 along "
                              "x, 0 to 23 along z: what lies outside counts as scanned"));
    CHECK_THAT(bench.run(verb + fits).err, !Contains("beyond"));
  }
}

TEST_CASE("region: Otsu's threshold is that of the core", "[region]") {
  const Bench bench;
  const Core core(bench);
  const std::string ice = bench.bytes("full.raw");
  std::string gray(ice.size(), '\0');
  uint32_t state = 1;
  for (size_t i = 0; i < ice.size(); ++i) {
    state = state * 1664525 + 1013904223;
    if (isInCore(int(i % kSide), int(i / kSide % kSide)))
      gray[i] = char((ice[i] ? 140 : 90) + int(state >> 28));
  }
  bench.write("gray.raw", gray);
  bench.mustRun("convert gray.raw gray.npy --dims 48x48x48 --type uint8");
  CHECK_THAT(bench.run("segment gray.npy g.vdb --threshold otsu").err, Contains("field of view"));
  const Outcome outcome =
      bench.run("segment gray.npy g.vdb --threshold otsu --roi cylinder --json s.json");
  CHECK(outcome.exitCode == 0);
  CHECK(Json::parse(bench.bytes("s.json")).at("object_voxels") == core.object);
}

TEST_CASE("region: what cannot be one is refused in a line", "[region]") {
  const Bench bench;
  const Core core(bench);
  const std::string segment = "segment full.npy o.vdb ";
  for (const std::string roi : {"cylinder:q", "cylinder:", "cylinder:z:1", "cylinder:z:1,2,3",
                                "cylinder:z:a,b", "cylinder:z:1,2:0", "cylinder:z:1,2:-3",
                                "cylinder:z:1,2:nan", "cylinder:z:1,2:3:4", "-", "mask.raw"})
    refuses(bench, kWrongUsage, segment + "--roi " + roi, {"--roi "});
  for (const std::string crop : {"1,2,3", "0,0,0:-1,5,5", "a,b,c:1,2,3", "0,0,0:99999999,1,1"})
    refuses(bench, kWrongUsage, segment + "--crop " + crop, {"--crop " + crop});
  refuses(bench, kWrongUsage, "segment full.npy view.npy --roi view.npy", {"view.npy"});
  refuses(bench, kWrongUsage, "convert full.npy o.vdb --labels --roi cylinder:q", {"--roi"});
  refuses(bench, kFailed, segment + "--roi missing.tif", {"missing.tif", "No such file"});
  refuses(bench, kFailed, segment + "--crop 90,0,0:99,9,9", {"full.npy", "no voxel"});
  refuses(bench, kFailed, segment + "--roi cylinder:z:99,99:3", {"full.npy", "no voxel"});
  refuses(bench, kFailed, segment + "--roi cylinder:z:99,99", {"full.npy", "give one"});
  refuses(bench, kFailed, "segment full.npy o.vdb --roi view.npy --crop 0,0,0:1,1,1",
          {"full.npy", "no voxel"});
  bench.mustRun("generate snow other.npy --size 40 --length 14");
  refuses(bench, kFailed, segment + "--roi other.npy", {"other.npy", "40x40x40", "48x48x48"});
}
