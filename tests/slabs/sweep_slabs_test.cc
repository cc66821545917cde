// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// The rows of mergingSweep() in slabs against those of the whole, whose flaws are compared with the
// oracle.

#include "vdb_madf/slabs/sweep_slabs.h"

#include <vector>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "support/slab_objects.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

LabelSlabs manifoldSlabsOf(const MaskGrid& mask, const std::vector<int>& cuts,
                           SegmentOptions options) {
  std::vector<Int32Grid::Ptr> slabs;
  options.keepManifold = true;
  MemoryScratch scratch;
  segmentSlabs(cutObject(mask, cuts), options, scratch,
               [&](size_t, const SlabGrids& grids) { slabs.push_back(grids.manifold); });
  LabelSlabs result;
  result.cuts = cuts;
  result.about = openvdb::gridConstPtrCast<Int32Grid>(slabs.at(0)->copyGridWithNewTree());
  result.read = [slabs](size_t slab, Interrupter*) { return slabs[slab]->deepCopy(); };
  return result;
}

void requireSameRows(const std::vector<SweepRow>& rows, const std::vector<SweepRow>& expected) {
  REQUIRE(rows.size() == expected.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    const SweepRow &a = rows[i], &b = expected[i];
    INFO("row " << i);
    REQUIRE(a.gamma == b.gamma);
    REQUIRE(a.mode == b.mode);
    REQUIRE(a.theta == b.theta);
    REQUIRE(a.delta == b.delta);
    REQUIRE(a.grains == b.grains);
    REQUIRE(a.medianVoxels == b.medianVoxels);
    REQUIRE(a.smallGrains == b.smallGrains);
    REQUIRE(a.smallVoxels == b.smallVoxels);
    REQUIRE(a.largestVoxels == b.largestVoxels);
    REQUIRE(a.objectVoxels == b.objectVoxels);
    REQUIRE(a.flaws.crumbs == b.flaws.crumbs);
    REQUIRE(a.flaws.specks == b.flaws.specks);
    REQUIRE(a.flaws.slivers == b.flaws.slivers);
    REQUIRE(a.flaws.inPieces == b.flaws.inPieces);
  }
}

}  // namespace

TEST_CASE("sweep_slabs: rows are those of the whole", "[sweep_slabs]") {
  initialize();
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1) + 700000,
                 cases = fromEnvironment("VDB_MADF_CASES", 8 * kCombinations);
  LabelFlaws sum;
  uint64_t compared = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(1, 16), rng.between(1, 16), rng.between(9, 60)));
    if (rng.chance(0.1)) drawRegion(c);
    INFO(describe(c));
    const MaskGrid::Ptr mask = maskOf(c);
    SegmentOptions options = optionsOf(c);
    options.domain = domainOf(c);
    options.keepDistance = options.keepPower = options.keepBalls = false;
    options.keepManifold = true;
    if (!options.weights) options.weights = VoxelWeights{};
    CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
    if (box.empty()) box = CoordBBox(Coord(0), Coord(7));
    options.tidy = 0;
    Segmentation whole;
    LabelSlabs manifolds;
    try {
      whole = segment(*mask, options);
      manifolds = manifoldSlabsOf(*mask, randomCuts(box, rng), options);
    } catch (const std::logic_error&) {
      continue;  // the object leaves the domain
    } catch (const InvalidInput&) {
      continue;
    }
    SweepOptions sweep;
    sweep.gammas = {options.gamma};
    sweep.modes = {MergeMode::both, MergeMode::score, MergeMode::angle};
    sweep.strictnesses = {11, 6};
    sweep.thetas = {-1, -0.8};
    sweep.deltas = {0, 3};
    sweep.smallVoxels = rng.between(1, 200);
    sweep.minGrain = seed % 3 ? 0 : 20;
    sweep.tidy = rng.chance(0.3) ? 0 : rng.below(4);
    const std::vector<SweepRow> expected = mergingSweep(*whole.manifold, sweep);
    MemoryScratch scratch;
    requireSameRows(withThreads(c.threads, [&] { return mergingSweep(manifolds, sweep, scratch); }),
                    expected);
    for (const SweepRow& row : expected) {
      sum.crumbs += row.flaws.crumbs;
      sum.specks += row.flaws.specks;
      sum.slivers += row.flaws.slivers;
      sum.inPieces += row.flaws.inPieces;
    }
    ++compared;
  }
  if (cases < 3 * uint64_t(kCombinations)) return;
  CHECK(compared > cases * 3 / 4);
  CHECK(sum.crumbs > 50);
  CHECK(sum.specks > 50);
  CHECK(sum.slivers > 50);
  CHECK(sum.inPieces > 20);
}

TEST_CASE("sweep_slabs: a block that is cut is one grain in one piece", "[sweep_slabs]") {
  initialize();
  MaskGrid mask;
  mask.tree().fill(CoordBBox(Coord(0, 0, 0), Coord(9, 9, 15)), true);
  SegmentOptions options;
  options.domain = CoordBBox(Coord(-3), Coord(20));
  const LabelSlabs manifolds = manifoldSlabsOf(mask, {-8, 0, 8, 16, 24}, options);
  MemoryScratch scratch;
  const std::vector<SweepRow> rows = mergingSweep(manifolds, {}, scratch);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].grains == 1);
  CHECK(rows[0].objectVoxels == 1600);
  CHECK(rows[0].flaws.inPieces == 0);
  CHECK(rows[0].flaws.slivers == 0);
}

TEST_CASE("sweep_slabs: options that are none are refused", "[sweep_slabs]") {
  initialize();
  MaskGrid mask;
  mask.tree().fill(CoordBBox(Coord(0, 0, 0), Coord(9, 9, 30)), true);
  SegmentOptions options;
  options.domain = CoordBBox(Coord(-3), Coord(40));
  const LabelSlabs manifolds = manifoldSlabsOf(mask, {-8, 0, 8, 48}, options);
  const auto refused = [&](const SweepOptions& sweep) {
    MemoryScratch scratch;
    CHECK_THROWS_AS(mergingSweep(manifolds, sweep, scratch), InvalidInput);
  };
  SweepOptions sweep;
  sweep.thetas = {};
  refused(sweep);
  sweep.thetas = {-1, 2};
  refused(sweep);
  sweep = {};
  sweep.tidy = -1;
  refused(sweep);
  sweep.tidy = 9;  // slabs are lower
  refused(sweep);
  MemoryScratch scratch;
  StopAtOnce stop;
  CHECK_THROWS_AS(mergingSweep(manifolds, {}, scratch, &stop), Interrupted);
}
