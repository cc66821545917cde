// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The verb verify, run as a user runs it; what it finds: verify/verify_test.cc.

#include "support/catch.h"
#include "support/command_runs.h"
#include "support/refusals.h"

using namespace vdb_madf::test;

TEST_CASE("cli: labels hold for the object that they were made of, read as it was", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.npy");
  bench.mustRun("segment s.npy g.vdb --phase 1 --keep manifold --strictness 9");
  CHECK_THAT(bench.mustRun("verify g.vdb s.npy --phase 1"), StartsWith("g.vdb: holds: each of "));
  CHECK(bench.mustRun("verify g.vdb s.npy --phase 1 -q") == "");
  bench.mustRun("remerge g.vdb r.vdb --merge both --theta -0.7");
  bench.mustRun("verify r.vdb s.npy --phase 1");
  bench.mustRun("segment s.npy p.vdb --phase 1 --paper --gamma 8 --boundary closed");
  bench.mustRun("verify p.vdb s.npy --phase 1");
  bench.mustRun("segment s.npy s.slabs --phase 1 --slab-height 16 --min-grain 50");
  bench.mustRun("verify s.slabs s.npy --phase 1");
  bench.mustRun(
      "segment s.npy c.vdb --phase 1 -q --roi cylinder:z:20,21:17 --voxel-size 1x1x1.5um");
  bench.mustRun("verify c.vdb s.npy --phase 1 -q --roi cylinder:z:20,21:17");

  refuses(bench, kFailed, "verify c.vdb s.npy --phase 1",
          {"c.vdb: are not the labels of s.npy: their domain is not that of the object"});
  refuses(bench, kFailed, "verify g.vdb s.npy --phase 0",
          {"g.vdb: are not the labels of s.npy: ", " voxels differ: the first, [", ", has ",
           " and should have "});
  refuses(bench, kFailed, "verify g.vdb s.npy --phase 1 --max-memory 2MiB",
          {"g.vdb: verifying a box of 48 x 48 x 48 voxels needs about 3.38 MiB", "--max-memory"});
}

TEST_CASE("cli: labels that no definition gives are not verified", "[cli]") {
  const Bench bench;
  bench.mustRun(kSnow + "s.vdb");
  bench.mustRun("segment s.vdb g.vdb");
  bench.mustRun("edit g.vdb e.vdb --merge 1,2");
  bench.mustRun("convert g.vdb g.tif");
  refuses(bench, kFailed, "verify e.vdb s.vdb", {"e.vdb: the labels were edited"});
  refuses(bench, kFailed, "verify g.tif s.vdb", {"g.tif: the labels do not say madf_"});
  refuses(bench, kWrongUsage, "verify g.vdb", {"OBJECT"});
}
