// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// From a gray scan to grains, run as a user runs it.

#include <cstring>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

/// A snow sample as a scan of 16 bits: `s.tif`; the object from which it was made is `clean.vdb`.
void makeScan(const Bench& bench) {
  bench.mustRun("generate snow clean.tif --size 64 --length 24");
  bench.mustRun("convert clean.tif clean.vdb");
  bench.mustRun("convert clean.tif soft.raw --smooth 0.6");
  const std::string soft = bench.bytes("soft.raw");
  std::string gray;
  uint32_t state = 1;
  for (size_t i = 0; i + 4 <= soft.size(); i += 4) {
    float value;
    std::memcpy(&value, &soft[i], 4);
    state = state * 1664525 + 1013904223;
    const auto sample = uint16_t(20000 + 15000 * value + float(state >> 20));
    gray.append(reinterpret_cast<const char*>(&sample), 2);
  }
  bench.write("s.raw", gray);
  bench.mustRun("convert s.raw s.tif --dims 64x64x64 --type uint16");
}

Outcome refused(const Bench& bench, const std::string& arguments) {
  const Outcome outcome = bench.run(arguments);
  CHECK(outcome.exitCode == 1);
  CHECK_THAT(outcome.err, !Contains("closed"));
  return outcome;
}

}  // namespace

TEST_CASE("gray: a scan without a selection is refused by every verb", "[gray]") {
  const Bench bench;
  makeScan(bench);
  const auto before = bench.names();
  for (const std::string verb :
       {"segment s.tif o.vdb", "segment s.tif o.vdb --boundary closed", "convert s.tif o.vdb",
        "sweep s.tif o.csv", "segment s.tif o.vdb --invert"}) {
    CAPTURE(verb);
    CHECK_THAT(refused(bench, verb).err, Contains("s.tif: is a gray image (uint16, values ") &&
                                             Contains("Otsu's threshold is ") &&
                                             Contains("--threshold otsu"));
  }
  bench.mustRun("convert clean.vdb ones.tif --threshold 0");
  CHECK(bench.names().size() == before.size() + 1);
  bench.mustRun("convert s.tif all.vdb --threshold 1");
  CHECK_THAT(refused(bench, "segment all.vdb o.vdb").err, Contains("fills the whole domain"));
}

TEST_CASE("gray: Otsu's threshold takes the object back out of a scan", "[gray]") {
  const Bench bench;
  makeScan(bench);
  const std::string options = " --threshold otsu --median 1 --smooth 0.3 --despeckle 20";
  const std::string printed = bench.mustRun("segment s.tif g.vdb --json j.json" + options);
  const Json json = Json::parse(bench.bytes("j.json"));
  const auto steps = json.at("object").get<std::string>();
  CHECK_THAT(steps, vdb_madf::test::StartsWith("median 1, smooth 0.3, value >= ") &&
                        Contains("(otsu), despeckle 20 ("));
  CHECK_THAT(printed, Contains(steps));
  CHECK(json.at("threshold") == "otsu");
  CHECK(json.at("threshold_value").get<double>() == Approx(29500).margin(1500));
  const Json metadata = gridOf(infoOf(bench, "g.vdb"), "grain").at("metadata");
  CHECK(metadata.at("madf_object") == steps);
  CHECK(metadata.at("madf_threshold") == json.at("threshold_value"));
  // By way of a mask the labels are the same, and say the same of themselves.
  CHECK_THAT(bench.mustRun("convert s.tif m.vdb" + options), Contains(steps));
  bench.mustRun("segment m.vdb h.vdb");
  CHECK(gridOf(infoOf(bench, "h.vdb"), "grain").at("metadata").at("madf_object") == steps);
  bench.mustRun("segment s.tif one.vdb --threads 1" + options);
  CHECK(bench.bytes("one.vdb") == bench.bytes("g.vdb"));

  bench.mustRun("convert s.tif otsu.vdb --threshold otsu");
  const double found = infoOf(bench, "otsu.vdb").at("grids")[0].at("active_voxels");
  CHECK(
      found ==
      Approx(double(infoOf(bench, "clean.vdb").at("grids")[0].at("active_voxels"))).epsilon(0.01));
}

TEST_CASE("gray: a scan is no image of labels, and what selects nothing is said", "[gray]") {
  const Bench bench;
  makeScan(bench);
  for (const std::string verb :
       {"measure s.tif t", "render s.tif o.png", "export s.tif o.ply", "compare s.tif s.tif"}) {
    CAPTURE(verb);
    CHECK_THAT(refused(bench, verb).err,
               Contains("s.tif: is a gray image, with values from ") &&
                   Contains("segment it first (or, if it holds labels, convert --labels)"));
  }
  const Outcome labels = bench.run("convert s.tif o.vdb --labels");
  CHECK(labels.exitCode == 0);
  CHECK_THAT(labels.err, Contains("vdb_madf: note: s.tif: its values, from ") &&
                             Contains("are taken for labels, as was said"));
  const Outcome nothing = bench.run("segment s.tif o.vdb --phase 1");
  CHECK(nothing.exitCode == 0);
  CHECK_THAT(nothing.err, Contains("vdb_madf: note: s.tif: nothing is selected"));
}

TEST_CASE("gray: an object says how it was made, not how the one before was", "[gray]") {
  const Bench bench;
  makeScan(bench);
  bench.mustRun("convert s.tif a.vdb --threshold OTSU");
  CHECK_THAT(bench.mustRun("info a.vdb"), Contains("madf_threshold = "));
  bench.mustRun("convert a.vdb b.vdb --invert");
  CHECK_THAT(bench.mustRun("info b.vdb"), !Contains("madf_threshold") && !Contains("otsu"));
}

TEST_CASE("gray: several phases make one object", "[gray]") {
  const Bench bench;
  bench.write("p.raw", std::string("\0\1\2\3\0\1\2\3", 8));
  const std::string layout = " --dims 4x2x1 --type uint8";
  CHECK_THAT(
      refused(bench, "convert p.raw o.vdb" + layout).err,
      Contains("has the values 0, 1, 2, 3: say which of them are object") && Contains("--phase"));
  bench.mustRun("convert p.raw o.raw --phase 1,3" + layout);
  CHECK(bench.bytes("o.raw") == std::string("\0\1\0\1\0\1\0\1", 8));
  bench.mustRun("convert p.raw o.raw --phase 1,3 --invert" + layout);
  CHECK(bench.bytes("o.raw") == std::string("\1\0\1\0\1\0\1\0", 8));
  bench.mustRun("convert p.raw o.raw --threshold 1:3" + layout);
  CHECK(bench.bytes("o.raw") == std::string("\0\1\1\1\0\1\1\1", 8));
}

TEST_CASE("gray: filters are for images, despeckling is for any volume", "[gray]") {
  const Bench bench;
  makeScan(bench);
  for (const std::string option : {"--threshold otsu", "--threshold 1:2", "--median 1"}) {
    CHECK_THAT(refused(bench, "segment clean.vdb o.vdb " + option).err, Contains("images"));
    CHECK_THAT(refused(bench, "convert clean.vdb o.vdb " + option).err, Contains("images"));
  }
  bench.mustRun("convert clean.vdb d.vdb --despeckle 1000");
  CHECK_THAT(gridOf(infoOf(bench, "d.vdb"), "object").at("metadata").at("madf_object"),
             vdb_madf::test::Predicate<std::string>(
                 [](const std::string& steps) { return steps.rfind("despeckle 1000 (", 0) == 0; }));
  // Without a selection a filter leaves an image an image.
  bench.mustRun("convert s.tif median.tif --median 1");
  CHECK(infoOf(bench, "median.tif").at("type") == "uint16");
}

TEST_CASE("gray: info says what the values of an image are", "[gray]") {
  const Bench bench;
  makeScan(bench);
  const Json scan = Json::parse(bench.mustRun("info s.tif --json - --histogram h.svg"));
  CHECK(scan.at("kind") == "gray");
  CHECK(scan.at("type") == "uint16");
  CHECK(scan.at("value_min").get<int>() >= 20000);
  CHECK(scan.at("value_max").get<int>() <= 39096);
  CHECK(scan.at("otsu_threshold").get<double>() == Approx(29500).margin(1500));
  CHECK(scan.at("otsu_object_share").get<double>() == Approx(0.3).margin(0.2));
  CHECK(scan.at("histogram_counts").size() == 256);
  CHECK_THAT(bench.bytes("h.svg"), Contains("</svg>"));
  const std::string printed = bench.mustRun("info s.tif");
  CHECK_THAT(printed, Contains("kind: gray") && Contains("otsu_threshold: ") &&
                          Contains("histogram: ") && !Contains("histogram_counts"));
  // What it suggests is what --threshold otsu takes.
  bench.mustRun("convert s.tif m.vdb --threshold otsu");
  CHECK(gridOf(infoOf(bench, "m.vdb"), "object").at("metadata").at("madf_threshold") ==
        scan.at("otsu_threshold"));
  CHECK(infoOf(bench, "s.tif --header").count("kind") == 0);

  const Json mask = infoOf(bench, "clean.tif");
  CHECK(mask.at("kind") == "mask");
  CHECK(mask.at("voxels_of_value").size() == 2);
  CHECK(mask.at("voxels_of_value")[0][1].get<int>() + mask.at("voxels_of_value")[1][1].get<int>() ==
        64 * 64 * 64);
  const int grains = Json::parse(bench.mustRun("segment clean.vdb g.vdb --json -")).at("grains");
  bench.mustRun("convert g.vdb g.tif");
  const Json labels = infoOf(bench, "g.tif");
  CHECK(labels.at("kind") == (grains > 4 ? "labels" : "phases"));
  CHECK(labels.value("labels", grains) == grains);
}

TEST_CASE("gray: info of a folder says how many slices there are, and which", "[gray]") {
  const Bench bench;
  bench.mustRun("generate snow a.tif --dims 20x20x1 --length 8");
  std::filesystem::create_directory(bench.path("slices"));
  for (const std::string name : {"s9.tif", "s10.tif", "s11.tif"})
    bench.write("slices/" + name, bench.bytes("a.tif"));
  const Json info = infoOf(bench, "slices");
  CHECK(info.at("files") == 3);
  CHECK(info.at("first_file") == "s9.tif");
  CHECK(info.at("last_file") == "s11.tif");
  CHECK(infoOf(bench, "a.tif").count("files") == 0);
}

TEST_CASE("gray: the intervals of a noisy scan hold the true numbers", "[gray]") {
  const Bench bench;
  bench.mustRun(
      "generate sintered truth.vdb --size 100 --count 30 --radius 7:12 --gray s.tif "
      "--scan-noise 0.7:0.08");
  bench.mustRun("measure truth.vdb t");
  bench.mustRun("segment s.tif o.vdb --threshold otsu --smooth 0.7 --despeckle 27");
  bench.mustRun("measure o.vdb m --gray s.tif --sensitivity 10 --bootstrap 100 --edge-weights");
  const Json truth = Json::parse(bench.bytes("t/sample.json"));
  const Json found = Json::parse(bench.bytes("m/sample.json"));
  CHECK(found.at("grains") == truth.at("grains"));
  const auto holds = [&](const std::string& name, double value) {
    CAPTURE(name);
    const Json& interval = found.at(name);
    CHECK(interval.at("low").get<double>() <= value);
    CHECK(value <= interval.at("high").get<double>());
  };
  holds("solid_fraction_sensitivity", truth.at("solid_fraction"));
  holds("specific_surface_sensitivity_per_voxel", truth.at("specific_surface_per_voxel"));
  holds("grain_diameter_d50_by_volume_sensitivity_voxel",
        truth.at("grain_diameter_by_volume_voxel").at("d50"));
  holds("specific_surface_interval_per_voxel", truth.at("specific_surface_per_voxel"));
}

TEST_CASE("gray: necks are measured in the scan that is segmented", "[gray]") {
  const Bench bench;
  makeScan(bench);
  const std::string segment = "segment s.tif o.vdb --threshold otsu --tables t";
  CHECK_THAT(bench.mustRun(segment), Contains("hint") && Contains("--necks frees them of it"));
  CHECK_THAT(bench.mustRun("segment s.tif p.vdb --threshold 29500 --tables p"),
             Contains("--necks frees them of it"));
  CHECK_FALSE(Json::parse(bench.bytes("t/sample.json")).contains("scan_blur_voxel"));
  CHECK_THAT(bench.mustRun("measure o.vdb m"), Contains("thresholded scan") && Contains("--gray"));
  CHECK_THAT(bench.mustRun(segment + " --necks"), !Contains("--necks frees"));
  const std::string bonds = bench.bytes("t/bonds.csv");
  const Json sample = Json::parse(bench.bytes("t/sample.json"));
  CHECK(sample.at("scan_blur_voxel").get<double>() == Approx(0.6).margin(0.15));
  CHECK_THAT(bench.mustRun("measure o.vdb m --gray s.tif"),
             Contains("blur 0.") && Contains("necks in the scan"));
  CHECK((bench.bytes("m/bonds.csv") == bonds));
  const std::string again = "measure o.vdb r --gray s.tif --sensitivity 5";
  CHECK_THAT(bench.mustRun(again + " --vary gamma:0"),
             Contains("5 runs: threshold ") && Contains("in 90 % of them"));
  CHECK_THAT(bench.bytes("r/bonds.csv"), Contains(",p_bond,area_sd_"));
  CHECK_THAT(bench.bytes("r/grains.csv"), Contains(",p_grain,volume_sd_"));
  const Json recurring = Json::parse(bench.bytes("r/sample.json"));
  CHECK(recurring.at("sensitivity_gamma") == Json{1, 1});
  CHECK(recurring.at("specific_surface_sensitivity_per_voxel").at("low") <
        recurring.at("specific_surface_sensitivity_per_voxel").at("high"));
  bench.mustRun(segment + " --necks --crop 4,0,0:59,63,60");
  CHECK(Json::parse(bench.bytes("t/sample.json")).at("necks_confirmed").get<int>() > 0);
  bench.mustRun("segment s.tif byvalue.vdb --threshold 29500 --tables byvalue --necks -q");
  CHECK(bench.run("segment clean.vdb o.vdb --tables t --necks").exitCode == 2);
  CHECK(bench.run("segment s.tif o.vdb --threshold otsu --necks").exitCode == 2);
  // A threshold by its value is told, too, and in a part of the scan the runs stay in it.
  bench.mustRun("segment s.tif o.vdb --threshold 29500 --crop 4,0,0:59,63,60");
  bench.mustRun(again);
  CHECK(Json::parse(bench.bytes("r/sample.json")).at("segmentation").at("threshold") == 29500);
}
