// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the verbs of the command have in common, run as a user runs them: help, the version, how
// lengths are written, standard input and output. What they refuse: errors_test.cc and
// wrong_usage_test.cc.

#include <openvdb/version.h>

#include <filesystem>
#include <sstream>

#include "support/catch.h"
#include "support/command_runs.h"
#include "vdb_madf/base/version.h"

using namespace vdb_madf::test;
using vdb_madf::kVersion;

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
  bench.mustRun("segment s.vdb g.npy --boundary closed -q");
  CHECK(piped("segment - npy:- --boundary closed -q", bench.bytes("s.npy")) ==
        bench.bytes("g.npy"));
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
