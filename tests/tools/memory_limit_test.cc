// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// Commands where memory is short, run as a user runs them.

#include <fmt/core.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/command_runs.h"

using namespace vdb_madf::test;

namespace {

/// 0 or 1: done, or one line on stderr.
bool endsWell(const Outcome& outcome) {
  return (outcome.exitCode == 0 || outcome.exitCode == 1) &&
         std::count(outcome.err.begin(), outcome.err.end(), '\n') == outcome.exitCode;
}

}  // namespace

TEST_CASE("cli: within ulimit -v, a command ends with one line", "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack p.vdb --size 64 --radius 8:16");
  int refused = 0;
  for (int mebibytes = 100; mebibytes <= 360; mebibytes += 20) {
    CAPTURE(mebibytes);
    // A real start, as libraries take memory before the command does.
    const auto run = [&, mebibytes = mebibytes](const std::string& arguments) {
      const int status =
          std::system(fmt::format("cd {} && ulimit -v {} && exec {} {} >out 2>err", bench.path(""),
                                  mebibytes * 1024, VDB_MADF_TOOL, arguments)
                          .c_str());
      Outcome outcome;
      outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
      outcome.err = bench.bytes("err");
      return outcome;
    };
    if (run("--version").exitCode != 0) continue;  // libraries cannot start
    const Outcome outcome = run("segment p.vdb g.vdb --threads 4 -q");
    CAPTURE(outcome.exitCode, outcome.err);
    CHECK(endsWell(outcome));
    refused += outcome.exitCode;
  }
  CHECK(refused > 0);
}

TEST_CASE("cli: --max-memory ends a verb before it takes more, and leaves what was there",
          "[cli]") {
  const Bench bench;
  bench.mustRun("generate pack p.vdb --size 128 --radius 8:16");
  bench.mustRun("segment p.vdb g.vdb --voxel-size 10um");
  const std::string version = bench.mustRun("--version");
  const auto lacks = [&](const char* part) { return version.find(part) == std::string::npos; };
  for (const auto& [command, output] :
       std::vector<std::pair<std::string, std::string>>{{"measure g.vdb ", "o.h5"},
                                                        {"export g.vdb ", "o.stl"},
                                                        {"export g.vdb ", "o.glb"},
                                                        {"render g.vdb ", "o.png"},
                                                        {"report g.vdb ", "o.html"},
                                                        {"compare g.vdb g.vdb --json ", "o.json"},
                                                        {"track g.vdb g.vdb ", "o.vdb"},
                                                        {"edit g.vdb --join-below 50 ", "o.vdb"},
                                                        {"convert g.vdb ", "o.tif"}}) {
    CAPTURE(command, output);
    if (output == "o.h5" && lacks("HDF5 is read and written")) continue;
    if (output == "o.html" && lacks("Reports are written")) continue;
    bench.mustRun(command + output + " -q");
    const std::string bytes = bench.bytes(output);
    int refused = 0;
    bool isDone = false;
    for (int mebibytes = 40; mebibytes < 2000 && !isDone; mebibytes += mebibytes / 8) {
      CAPTURE(mebibytes);
      const Outcome outcome = bench.run(command + output + " -q --threads 4 --max-memory " +
                                        std::to_string(mebibytes) + "MiB");
      CAPTURE(outcome.exitCode, outcome.err);
      CHECK(endsWell(outcome));
      CHECK(bench.bytes(output) == bytes);
      isDone = outcome.exitCode == 0;
      refused += outcome.exitCode;
    }
    CHECK(refused > 0);
    CHECK(isDone);
  }
}
