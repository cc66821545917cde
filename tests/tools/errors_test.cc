// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the command refuses, and how: the exit code, one line on stderr, nothing on stdout, no file
// left.

#include <algorithm>
#include <csignal>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// Renames a metadata key in a VDB file, so that no program finds it.
void hideMetadata(const Bench& bench, const std::string& file, const std::string& key) {
  std::string bytes = bench.bytes(file);
  size_t at = bytes.find(key);
  REQUIRE(at != std::string::npos);
  for (; at != std::string::npos; at = bytes.find(key, at)) bytes[at] = '_';
  bytes[21] = '0';  // a UUID that is no digest, as other programs write
  bench.write(file, bytes);
}

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

}  // namespace

TEST_CASE("cli: a file that is missing or none of ours is named", "[cli]") {
  const Bench bench;
  std::filesystem::create_directory(bench.path("folder"));
  std::filesystem::create_directory(bench.path("folder.vdb"));
  std::string garbage(3000, '\0');
  uint32_t state = 1;
  for (char& c : garbage) c = char((state = state * 1664525 + 1013904223) >> 24);
  std::vector<std::string> files{"missing.vdb", "missing.tif", "missing", "folder", "folder.vdb"};
  for (const std::string ending :
       {".vdb", ".tif", ".mhd", ".mha", ".nrrd", ".nhdr", ".npy", ".png", ".bmp", ".isq", ".nii",
        ".nii.gz", ".vol", ".longvol", ".h5", ".xyz"}) {
    files.push_back("empty" + ending);
    files.push_back("garbage" + ending);
    bench.write("empty" + ending, "");
    bench.write("garbage" + ending, garbage);
  }
  const std::set<std::string> byEachVerb{"missing.vdb", "missing.tif", "folder",     "folder.vdb",
                                         "empty.vdb",   "garbage.vdb", "garbage.tif"};
  for (const std::string& file : files) {
    refuses(bench, kFailed, "segment " + file + " out.vdb", {file});
    refuses(bench, kFailed, "info " + file, {file});
    if (!byEachVerb.count(file)) continue;
    refuses(bench, kFailed, "convert " + file + " out.raw", {file});
    refuses(bench, kFailed, "render " + file + " out.png", {file});
    refuses(bench, kFailed, "report " + file + " out.html", {file});
    refuses(bench, kFailed, "remerge " + file + " out.vdb", {file});
    refuses(bench, kFailed, "edit " + file + " out.vdb --renumber", {file});
  }
  refuses(bench, kFailed, "info garbage.vdb", {"not a VDB file"});
  refuses(bench, kFailed, "compare missing.vdb empty.vdb", {"missing.vdb"});
  refuses(bench, kFailed, "track missing.vdb empty.vdb", {"missing.vdb"});
  bench.write("s.raw", std::string(64, '\1'));
  refuses(bench, kFailed, "segment s.raw out.vdb", {"s.raw", "--dims"});
  for (const std::string layout :
       {"--dims 4x4x5 --type uint8", "--dims 4x4x3 --type uint8", "--dims 4x4x4 --type uint16"})
    refuses(bench, kFailed, "segment s.raw out.vdb " + layout, {"s.raw", "64 bytes"});
}

TEST_CASE("cli: a truncated file is refused at any length", "[cli]") {
  const Bench bench;
  for (const std::string ending : {".vdb", ".tif", ".mha"}) {
    bench.mustRun("generate snow s" + ending + " --size 24 --length 8");
    const std::string bytes = bench.bytes("s" + ending), cut = "cut" + ending;
    for (const double share : {0.01, 0.1, 0.5, 0.9, 0.999}) {
      bench.write(cut, bytes.substr(0, size_t(share * double(bytes.size()))));
      refuses(bench, kFailed, "segment " + cut + " out.vdb", {cut});
    }
  }
  bench.mustRun("generate snow s.mhd --size 24 --length 8");
  bench.write("s.raw", bench.bytes("s.raw").substr(0, 1000));
  refuses(bench, kFailed, "segment s.mhd out.vdb", {"s.mhd", "s.raw"});
}

TEST_CASE("cli: a grid has to be there, usable and the only one", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep power,manifold");
  refuses(bench, kFailed, "segment s.vdb o.vdb --grid snow",
          {"s.vdb", "'snow'", "object", "truth"});
  refuses(bench, kFailed, "render s.vdb o.png --grid snow", {"s.vdb", "'snow'", "truth"});
  refuses(bench, kFailed, "render s.vdb o.png --grid object", {"s.vdb", "'object'", "bool"});
  bench.mustRun("convert s.vdb mask.vdb --grid object --phase 1");
  refuses(bench, kFailed, "render mask.vdb o.png", {"mask.vdb", "labels (int32)", "segment"});
  refuses(bench, kFailed, "segment g.vdb o.vdb", {"g.vdb", "--grid", "grain", "power", "manifold"});
  refuses(bench, kFailed, "compare s.vdb g.vdb --truth-grid snow", {"s.vdb", "'snow'"});
  refuses(bench, kFailed, "remerge s.vdb o.vdb", {"s.vdb", "segment again with --keep manifold"});
  refuses(bench, kFailed, "edit mask.vdb o.vdb --renumber", {"mask.vdb", "labels (int32)"});
  refuses(bench, kFailed, "edit s.vdb o.vdb --split 1", {"s.vdb", "with --keep manifold"});
  bench.mustRun("convert s.vdb s.tif --grid truth");
  refuses(bench, kFailed, "segment s.tif o.vdb --grid truth", {"s.tif", "--grid"});
  refuses(bench, kFailed, "segment s.tif o.vdb --dataset truth", {"s.tif", "--dataset"});
  refuses(bench, kFailed, "segment s.vdb o.vdb --dataset truth", {"s.vdb", "--dataset", "--grid"});
}

TEST_CASE("cli: labels are whole numbers of one sample", "[cli]") {
  const Bench bench;
  const std::string layout = " --dims 2x2x1 --type float32";
  bench.write("half.raw", floats({0, 1, 1.5f, 0}));
  bench.write("nan.raw", floats({0, 1, std::stof("nan"), 0}));
  bench.write("huge.raw", floats({0, 1, 3e9f, 0}));
  for (const std::string file : {"half.raw", "nan.raw", "huge.raw"}) {
    refuses(bench, kFailed, "render " + file + " o.png" + layout, {file});
    refuses(bench, kFailed, "compare " + file + " " + file + layout, {file});
    refuses(bench, kFailed, "convert " + file + " o.tif --out-type int32" + layout, {"int32"});
  }
  bench.write("a.raw", floats({1, 1, 0, 0}));
  bench.write("b.raw", floats({0, 0, 1, 1}));
  bench.write("none.raw", floats({0, 0, 0, 0}));
  for (const auto& [truth, test] : {std::pair<std::string, std::string>{"a.raw", "b.raw"},
                                    {"a.raw", "none.raw"},
                                    {"none.raw", "b.raw"}})
    refuses(bench, kFailed, "compare " + truth + " " + test + layout, {truth, test, "same sample"});
  bench.mustRun("compare none.raw none.raw" + layout);

  for (const std::string size : {"4", "8.5"})
    bench.mustRun("convert a.raw a" + size + ".mha --voxel-size " + size + "um" + layout);
  bench.mustRun("convert a.raw a.npy" + layout);
  refuses(bench, kFailed, "compare a4.mha a8.5.mha", {"a4.mha", "a8.5.mha", "2.125 times"});
  bench.mustRun("compare a4.mha a.npy");
}

TEST_CASE("cli: the boundary and the domain have to fit the object", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun(kSpheres + "s.tif");
  for (const std::string file : {"s.vdb", "s.tif"})
    refuses(bench, kFailed, "segment " + file + " o.vdb --domain 0,0,0:9,9,9",
            {file, "leaves the domain"});
  refuses(bench, kFailed, "segment s.tif o.vdb --threshold 0", {"s.tif", "by value", "threshold"});
  bench.mustRun("segment s.tif o.vdb --threshold 0 --boundary closed");
  refuses(bench, kFailed, "segment s.vdb x.vdb --invert --domain 0,0,0:1048575,1048575,1048575",
          {"s.vdb", "domain", "crop"});
  refuses(bench, kFailed, "convert s.tif x.raw --domain 0,0,0:9,9,9", {"s.tif", "--domain"});

  bench.write("unknown.vdb", bench.bytes("s.vdb"));
  hideMetadata(bench, "unknown.vdb", "madf_domain_m");
  refuses(bench, kFailed, "segment unknown.vdb x.vdb --boundary open",
          {"unknown.vdb", "closed", "--domain"});
  refuses(bench, kFailed, "segment unknown.vdb x.vdb --invert", {"unknown.vdb", "domain"});
  bench.mustRun("segment unknown.vdb a.vdb");
  bench.mustRun("segment unknown.vdb b.vdb --boundary closed");
  CHECK(bench.bytes("a.vdb") == bench.bytes("b.vdb"));
  bench.mustRun("segment unknown.vdb c.vdb --boundary open --domain 0,0,0:39,39,39");
  bench.mustRun("segment s.vdb d.vdb");
  CHECK(bench.bytes("c.vdb") == bench.bytes("d.vdb"));
  CHECK_THAT(bench.mustRun("convert unknown.vdb u.raw --grid object"),
             vdb_madf::test::Contains("origin"));
}

TEST_CASE("cli: a signal ends long work within a second and leaves nothing", "[cli]") {
  const Bench bench;
  // A sparse file: 512 MB of zeros, which the inversion turns into more work than a second's.
  bench.write("zeros.raw", "");
  std::filesystem::resize_file(bench.path("zeros.raw"), 800 * 800 * 800);
  const std::pair<int, double> cases[] = {
      {SIGINT, 0.0}, {SIGINT, 0.3}, {SIGTERM, 0.1}, {SIGHUP, 0.1}, {SIGQUIT, 0.1}};
  for (const auto& [signal, delay] : cases) {
    CAPTURE(signal, delay);
    RunOptions interrupted;
    interrupted.signal = signal;
    interrupted.delay = delay;
    interrupted.interruptOn = ".summary.json";  // the temporary file: the work has begun
    const auto before = bench.names();
    const Outcome outcome = bench.run(
        "segment zeros.raw o.vdb --dims 800x800x800 --type uint8 --invert --boundary closed"
        " --json summary.json",
        interrupted);
    checkRefusal(outcome, kInterrupted, {"interrupted"});
    CHECK(outcome.secondsAfterSignal < 1);
    CHECK(bench.names() == before);
  }
}

TEST_CASE("cli: segment refuses what needs more memory than allowed", "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  refuses(bench, kFailed, "segment s.vdb g.vdb --max-memory 2M",
          {"s.vdb", "MiB of memory, and", "MiB may be used", "--max-memory"});
  for (const std::string size : {"0", "-1G", "3X", "much", "1GiBB", "nan", "100", "16e9", "1,5G"})
    refuses(bench, kWrongUsage, "segment s.vdb g.vdb --max-memory " + size, {size, "12GiB"});
  bench.mustRun("segment s.vdb g.vdb --max-memory 1.5GiB");
  for (const std::string size : {"1.5 GiB", "2gib", "2gb", "900M", "1e9B", "1e6 kb"})
    CHECK(bench.run({"segment", "s.vdb", "g.vdb", "--max-memory", size}).exitCode == 0);
  refuses(bench, kWrongUsage, "segment s.vdb", {"OUT is required"});
}

TEST_CASE("cli: where memory ends, a line says so", "[cli]") {
  const Bench bench;
  bench.mustRun("generate sintered s.vdb --size 128 --count 60 --radius 11:18 -q");
  bench.mustRun("segment s.vdb g.vdb --grid object -q");
  // A mesh takes several times the memory of labels, so that it ends after they were read.
  RunOptions limits;
  limits.memory = 360 << 20;
  Outcome run = bench.run("export g.vdb o.obj -q --threads 1", limits);
  for (; run.exitCode == 0; limits.memory -= 20 << 20) {
    REQUIRE(limits.memory > 0);
    run = bench.run("export g.vdb o.obj -q --threads 1", limits);
  }
  INFO(limits.memory);
  CHECK(run.exitCode == kFailed);
  CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
  CHECK_THAT(run.err, Contains("out of memory"));
  for (const std::string& name : bench.names()) CHECK(name[0] != '.');  // no half of a file
}

TEST_CASE("cli: an image that is too long is refused before its samples are read", "[cli]") {
  const Bench bench;
  bench.write("long.mha",
              "ObjectType = Image\nNDims = 3\nDimSize = 2 2 30000\nElementType = MET_UCHAR\n"
              "CompressedData = True\nElementDataFile = LOCAL\n" +
                  std::string(1000, 'x'));
  for (const std::string arguments :
       {"segment long.mha o.vdb", "segment long.mha --dry-run", "sweep long.mha o.csv"})
    refuses(bench, kFailed, arguments, {"long.mha", "30000 voxels long", "26754"});
  CHECK_THAT(bench.mustRun("info long.mha --header"), vdb_madf::test::Contains("30000"));
}
