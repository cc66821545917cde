// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// remergeSlabs() against a fresh segment() of the whole, and what it refuses.

#include "vdb_madf/slabs/remerge_slabs.h"

#include <algorithm>
#include <string>
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

/// Manifolds that were cut.
struct Manifolds {
  std::vector<int> cuts;
  std::vector<Int32Grid::Ptr> slabs;

  LabelSlabs opened() const {
    LabelSlabs result;
    result.cuts = cuts;
    result.about = openvdb::gridConstPtrCast<Int32Grid>(slabs.at(0)->copyGridWithNewTree());
    result.read = [this](size_t slab, Interrupter*) { return slabs[slab]->deepCopy(); };
    return result;
  }
};

Manifolds manifoldsOf(const MaskGrid& mask, std::vector<int> cuts, SegmentOptions options) {
  Manifolds result;
  result.cuts = cuts;
  options.keepManifold = true;
  MemoryScratch scratch;
  segmentSlabs(
      cutObject(mask, std::move(cuts)), options, scratch,
      [&](size_t, const SlabGrids& grids) { result.slabs.push_back(grids.manifold->deepCopy()); });
  return result;
}

struct Remerged {
  Int32Grid::Ptr labels;
  std::vector<int64_t> grainVoxels;
};

Remerged remergeCut(const Manifolds& manifolds, const MergeOptions& merge, int tidy) {
  Remerged result;
  MemoryScratch scratch;
  result.grainVoxels = remergeSlabs(manifolds.opened(), merge, tidy, scratch,
                                    [&](size_t, const Int32Grid::Ptr& grain) {
                                      if (result.labels)
                                        result.labels->tree().merge(grain->tree());
                                      else
                                        result.labels = grain;
                                    });
  return result;
}

/// Two balls with a neck at a cut.
MaskGrid twoBalls() {
  MaskGrid mask;
  for (const Coord& center : {Coord(9, 9, 9), Coord(9, 9, 22)})
    for (auto p = CoordBBox::createCube(center.offsetBy(-8), 17).begin(); p; ++p)
      if ((*p - center).asVec3i().lengthSqr() <= 64) mask.tree().setValueOn(*p);
  return mask;
}

}  // namespace

TEST_CASE("remerge_slabs: labels are those of a fresh segmentation", "[remerge_slabs]") {
  initialize();
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1) + 500000,
                 cases = fromEnvironment("VDB_MADF_CASES", 12 * kCombinations);
  uint64_t compared = 0, others = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(1, 14), rng.between(1, 14), rng.between(9, 60)));
    if (rng.chance(0.1)) drawRegion(c);
    INFO(describe(c));
    const MaskGrid::Ptr mask = maskOf(c);
    SegmentOptions options = optionsOf(c);
    options.domain = domainOf(c);
    options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = false;
    if (!options.weights) options.weights = VoxelWeights{};
    CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
    if (box.empty()) box = CoordBBox(Coord(0), Coord(7));
    std::vector<int> cuts = randomCuts(box, rng);
    SegmentOptions other = options;
    const double thetas[] = {-1, -0.9, -0.8, -0.5, 0};
    other.merge = {MergeMode(rng.below(4)), double(rng.between(4, 16)),
                   thetas[rng.below(5)],    rng.chance(0.5) ? 0 : rng.below(9),
                   Adjacency(rng.below(2)), seed % 3 ? 0 : int64_t(seed % 101)};
    other.tidy = rng.below(9);
    options.tidy = 0;
    Segmentation whole;
    Manifolds manifolds;
    try {
      whole = segment(*mask, other);
      manifolds = manifoldsOf(*mask, cuts, options);
    } catch (const std::logic_error&) {
      continue;  // the object leaves the domain
    } catch (const InvalidInput&) {
      continue;
    }
    const Remerged remerged =
        withThreads(c.threads, [&] { return remergeCut(manifolds, other.merge, other.tidy); });
    REQUIRE(areSame(*whole.grain, *remerged.labels));
    REQUIRE(whole.grainVoxels == remerged.grainVoxels);
    ++compared;
    others += manifolds.slabs.size() > 2;
  }
  if (cases < 3 * uint64_t(kCombinations)) return;
  CHECK(compared > cases * 3 / 4);
  CHECK(others > cases / 2);
}

TEST_CASE("remerge_slabs: manifolds that do not fit their graph are refused", "[remerge_slabs]") {
  initialize();
  const MaskGrid mask = twoBalls();
  const Manifolds good = manifoldsOf(mask, {0, 8, 16, 24, 32}, {});
  REQUIRE(
      remergeCut(good, {MergeMode::neck, 11, -1, 0, Adjacency::manifold}, 2).grainVoxels.size() ==
      2);
  REQUIRE(
      remergeCut(good, {MergeMode::neck, 11, 1, 0, Adjacency::manifold}, 2).grainVoxels.size() ==
      1);
  const auto refused = [&](const std::string& why, auto change) {
    Manifolds changed = good;
    for (Int32Grid::Ptr& slab : changed.slabs) slab = slab->deepCopy();
    change(changed.slabs);
    for (const MergeMode mode : {MergeMode::score, MergeMode::both})
      CHECK_THROWS_WITH(remergeCut(changed, {mode}, 2), vdb_madf::test::Contains(why));
  };
  using Slabs = std::vector<Int32Grid::Ptr>;
  const auto changePart = [](Int32Grid& slab, auto change) {
    GraphPart part = storedGraphPart(slab).value();
    change(part);
    setGraphPart(slab, part);
  };
  refused("carries no part", [](Slabs& slabs) { removeGraph(*slabs[2]); });
  refused("carries no part", [](Slabs& slabs) { setGraph(*slabs[2], {}); });
  refused("that its graph does not know",
          [](Slabs& slabs) { slabs[1]->beginValueOn().setValue(1000000); });
  refused("that its graph does not know",
          [](Slabs& slabs) { slabs[1]->beginValueOn().setValue(0); });
  refused("its graph says", [](Slabs& slabs) { slabs[1]->beginValueOn().setValueOff(); });
  refused("not of one", [&](Slabs& slabs) {
    changePart(*slabs[1], [](GraphPart& p) { std::fill(p.goesOn.begin(), p.goesOn.end(), 0); });
  });
  refused("not of one", [&](Slabs& slabs) {
    changePart(*slabs[3], [](GraphPart& p) { std::fill(p.goesOn.begin(), p.goesOn.end(), 1); });
  });
  refused("another one in another slab", [&](Slabs& slabs) {
    changePart(*slabs[3], [](GraphPart& p) {
      for (auto& node : p.graph.nodes) ++node.squaredRadius;
    });
  });
}

TEST_CASE("remerge_slabs: options and slabs that are none are refused", "[remerge_slabs]") {
  initialize();
  const Manifolds manifolds = manifoldsOf(twoBalls(), {0, 8, 16, 32}, {});
  CHECK_THROWS_AS(remergeCut(manifolds, {MergeMode::both, 11, 2, 0, Adjacency::manifold}, 2),
                  InvalidInput);
  CHECK_THROWS_AS(remergeCut(manifolds, {}, -1), InvalidInput);
  CHECK_THROWS_AS(remergeCut(manifolds, {}, 9), InvalidInput);  // the slab in the middle is lower
  MemoryScratch scratch;
  StopAtOnce stop;
  const auto ignore = [](size_t, const Int32Grid::Ptr&) {};
  CHECK_THROWS_AS(remergeSlabs(manifolds.opened(), {}, 2, scratch, ignore, &stop), Interrupted);
}
