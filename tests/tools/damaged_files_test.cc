// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What the command does with files of ours whose content is not what was written; which changes are
// found: vdb/vdb_digest_test.cc.

#include <filesystem>

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

namespace {

/// Changes a letter of a text in a file.
void damage(const Bench& bench, const std::string& file, const std::string& text) {
  std::string bytes = bench.bytes(file);
  const size_t at = bytes.find(text);
  REQUIRE(at != std::string::npos);
  bytes[at + text.size() - 1] ^= 1;
  bench.write(file, bytes);
}

}  // namespace

TEST_CASE("cli: every verb refuses a file that is not what was written, unless told otherwise",
          "[cli]") {
  const Bench bench;
  bench.mustRun(kSpheres + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb --keep manifold,distance");
  bench.mustRun("segment s.vdb g.slabs --slab-height 16 --keep manifold");
  bench.mustRun("convert g.vdb copy.vdb");
  damage(bench, "s.vdb", "madf_source");
  damage(bench, "g.vdb", "madf_strictness");
  damage(bench, "g.slabs/index.json", "\"version");
  bench.mustRun("segment copy.vdb more.slabs --slab-height 16 --keep manifold --grid grain");
  damage(bench, "more.slabs/slab-0001.vdb", "file_bbox_max");
  for (const std::string run : {"segment s.vdb out.vdb",
                                "segment s.vdb out.slabs --slab-height 16",
                                "remerge g.vdb out.vdb --strictness 9",
                                "edit g.vdb out.vdb --renumber",
                                "convert g.vdb out.vdb",
                                "convert g.vdb out.npy --grid distance_squared",
                                "sweep s.vdb out.csv --strictness 9,11",
                                "sweep g.vdb out.csv --grid grain --strictness 9,11",
                                "hierarchy g.vdb out.csv",
                                "measure g.vdb out",
                                "compare copy.vdb g.vdb",
                                "track g.vdb copy.vdb out.vdb",
                                "render g.vdb out.png",
                                "export g.vdb out.graphml --as network",
                                "info g.vdb",
                                "info g.slabs",
                                "measure g.slabs out",
                                "remerge g.slabs out.slabs",
                                "convert g.slabs out.vdb",
                                "hierarchy more.slabs out.csv",
                                "measure more.slabs out",
                                "info more.slabs",
                                "remerge more.slabs out.slabs"}) {
    refuses(bench, kFailed, run, {"is not what was written", "--no-verify"});
    INFO("vdb_madf " << run);
    CHECK(bench.run(run + " --no-verify -q").exitCode == 0);
    for (const char* made :
         {"out.vdb", "out.slabs", "out.npy", "out.csv", "out", "out.png", "out.graphml"})
      std::filesystem::remove_all(bench.path(made));
  }
}
