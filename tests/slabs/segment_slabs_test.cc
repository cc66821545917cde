// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// segmentSlabs() against segment(), which is compared with the oracle, and what it refuses.
//
// The random comparison reads from the environment VDB_MADF_CASES (how many) and VDB_MADF_SEED (the
// first).

#include "vdb_madf/slabs/segment_slabs.h"

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/random_case.h"
#include "support/runs.h"
#include "support/slab_objects.h"
#include "support/thread_team.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/initialize.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

struct CutResult {
  SlabSegmentation result;
  Int32Grid::Ptr labels;     ///< of all slabs; null without any
  Int32Grid::Ptr manifolds;  ///< the same, with the graph, if they are kept
};

/// Adds the grid of a slab to those below it.
void addSlab(Int32Grid::Ptr& all, const Int32Grid::Ptr& slab) {
  if (all)
    all->tree().merge(slab->tree());
  else
    all = slab;
}

/// Those of all slabs, if there are any.
void joinSlabs(const std::vector<SlabGrids>& slabs, CutResult& cut) {
  std::vector<GraphPart> parts;
  for (const SlabGrids& grids : slabs) {
    addSlab(cut.labels, grids.grain);
    if (!grids.manifold) continue;
    parts.push_back(storedGraphPart(*grids.manifold).value());
    addSlab(cut.manifolds, grids.manifold);
  }
  if (cut.manifolds) setGraph(*cut.manifolds, joinedGraph(parts));
}

CutResult segmentCut(const SlabObject& object, const SegmentOptions& options) {
  CutResult cut;
  MemoryScratch scratch;
  std::vector<SlabGrids> slabs;
  cut.result = segmentSlabs(object, options, scratch, [&](size_t slab, const SlabGrids& grids) {
    if (slab != slabs.size()) throw std::logic_error("slabs are put in another order");
    for (const Int32Grid::Ptr& grid : {grids.grain, grids.manifold})
      for (auto leaf = grid ? grid->tree().cbeginLeaf() : Int32Tree::LeafCIter(); leaf; ++leaf)
        if (leaf->origin().z() < object.cuts[slab] || leaf->origin().z() >= object.cuts[slab + 1])
          throw std::logic_error("labels outside of their slab");
    slabs.push_back(grids);
  });
  joinSlabs(slabs, cut);
  return cut;
}

/// The same by several members, each of which knows its own slabs alone.
CutResult segmentByMembers(const SlabObject& object, const SegmentOptions& options, int members) {
  CutResult cut;
  ThreadTeam team(members);
  std::vector<SlabGrids> slabs(object.slabCount());
  asMembers(team, [&](Team& member) {
    MemoryScratch scratch;
    SlabSegmentation result =
        segmentSlabs(object, options, scratch, member,
                     [&](size_t slab, const SlabGrids& grids) { slabs[slab] = grids; });
    if (member.member() == 0) cut.result = std::move(result);
  });
  if (members > 1 && object.slabCount() > 1 && cut.result.counts.objectVoxels > 0 &&
      team.messages == 0)
    throw std::logic_error("members sent nothing");
  joinSlabs(slabs, cut);
  return cut;
}

std::string difference(const Segmentation& whole, const CutResult& cut) {
  const SegmentCounts &a = whole.counts, &b = cut.result.counts;
  std::string text;
  const auto compare = [&](const char* name, int64_t x, int64_t y) {
    if (x != y) text += name + (" " + std::to_string(y)) + ", not " + std::to_string(x) + "\n";
  };
  compare("object voxels", a.objectVoxels, b.objectVoxels);
  compare("leaves", a.leaves, b.leaves);
  compare("cavities", a.cavities, b.cavities);
  compare("voxels of cavities", a.cavityVoxels, b.cavityVoxels);
  compare("largest D", a.largestSquaredDistance, b.largestSquaredDistance);
  compare("medial balls", a.medialBalls, b.medialBalls);
  compare("kept balls", a.keptBalls, b.keptBalls);
  compare("critical points", a.criticalPoints, b.criticalPoints);
  compare("grains", a.grains, b.grains);
  compare("fill-holes", whole.fillHoles, cut.result.fillHoles);
  compare("open", whole.open, cut.result.open);
  if (!(whole.weights == cut.result.weights)) text += "other weights\n";
  if (whole.grainVoxels != cut.result.grainVoxels) text += "other voxels of grains\n";
  if (cut.labels && !areSame(*whole.grain, *cut.labels)) text += "other labels or metadata\n";
  if (!cut.labels && whole.counts.objectVoxels > 0) text += "no labels\n";
  if (bool(whole.manifold) != bool(cut.manifolds) ||
      (whole.manifold && !areSame(*whole.manifold, *cut.manifolds)))
    text += "other manifolds, or another graph\n";
  return text;
}

struct Comparison {
  std::string difference;  ///< empty if there is none
  size_t slabs = 0;        ///< with object
  bool refused = false;
};

Comparison compareSlabs(const RandomCase& c) {
  const MaskGrid::Ptr mask = maskOf(c);
  SegmentOptions options = optionsOf(c);
  options.domain = domainOf(c);
  options.keepDistance = options.keepPower = options.keepBalls = false;
  options.keepManifold = c.seed % 2 == 0;
  if (!options.weights) options.weights = VoxelWeights{};
  Rng rng(c.seed);
  CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
  if (box.empty()) box = CoordBBox(Coord(0), Coord(7));
  Comparison result;
  std::string refused, refusedCut;
  Segmentation whole;
  CutResult cut;
  try {
    whole = segment(*mask, options);
  } catch (const InvalidInput& e) {
    refused = e.what();
  }
  try {
    const SlabObject object = cutObject(*mask, randomCuts(box, rng));
    for (size_t s = 0; s < object.slabCount(); ++s) result.slabs += !object.leaves(s).empty();
    const int members = rng.chance(0.4) ? rng.between(2, 4) : 1;
    cut = withThreads(c.threads, [&] {
      return members > 1 ? segmentByMembers(object, options, members) : segmentCut(object, options);
    });
  } catch (const std::logic_error&) {
    result.refused = true;  // the object leaves the domain
    return result;
  } catch (const InvalidInput& e) {
    refusedCut = e.what();
  }
  result.refused = !refused.empty();
  if (refused.empty() != refusedCut.empty())
    result.difference = "whole: '" + refused + "', in slabs: '" + refusedCut + "'";
  else if (refused.empty())
    result.difference = difference(whole, cut);
  return result;
}

/// Compares that many volumes, tall ones if `height` is given, in regions if asked for.
void requireSameAsWhole(uint64_t first, uint64_t cases, int height, bool inRegions = false) {
  uint64_t compared = 0, several = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed + 9000);
    std::optional<Coord> size;
    if (height > 0)
      size = Coord(rng.between(1, 12), rng.between(1, 12),
                   rng.between(16, seed % 6 == 0 ? 3 * height : height));
    RandomCase c = randomCase(seed, size);
    if (inRegions) drawRegion(c);
    const Comparison comparison = compareSlabs(c);
    compared += !comparison.refused;
    several += comparison.slabs > 1;
    if (comparison.difference.empty()) continue;
    const RandomCase small =
        shrink(c, [](const RandomCase& d) { return !compareSlabs(d).difference.empty(); });
    FAIL(describe(c) << comparison.difference << "shrunk to " << describe(small)
                     << compareSlabs(small).difference);
  }
  if (cases < 3 * uint64_t(kCombinations)) return;
  CHECK(compared > cases * 3 / 4);
  CHECK(several > (height > 0 ? cases / 2 : cases / 5));
}

/// A row of voxels along z.
SlabObject row(int length, std::vector<int> cuts) {
  MaskGrid mask;
  mask.tree().fill(CoordBBox(Coord(0), Coord(0, 0, length - 1)), true);
  return cutObject(mask, std::move(cuts));
}

}  // namespace

TEST_CASE("slabs: labels and counts are those of the whole", "[slabs]") {
  requireSameAsWhole(fromEnvironment("VDB_MADF_SEED", 1),
                     fromEnvironment("VDB_MADF_CASES", 10 * kCombinations), 0);
}

TEST_CASE("slabs: labels and counts of tall objects are those of the whole", "[slabs]") {
  requireSameAsWhole(fromEnvironment("VDB_MADF_SEED", 1) + 100000,
                     fromEnvironment("VDB_MADF_CASES", 8 * kCombinations), 90);
}

TEST_CASE("slabs: what gamma leaves is completed through many slabs, as in the whole", "[slabs]") {
  // Balls with long thin fibers, along z and winding, that the filter leaves without a ball;
  // hundreds of rounds, from both ends of a fiber and around loops.
  MaskGrid mask;
  const auto ball = [&](const Coord& center, int radius) {
    for (auto p = CoordBBox::createCube(center.offsetBy(-radius), 2 * radius + 1).begin(); p; ++p)
      if ((*p - center).asVec3i().lengthSqr() <= radius * radius) mask.tree().setValueOn(*p);
  };
  ball(Coord(6, 6, 6), 5);
  ball(Coord(20, 6, 330), 6);
  mask.tree().fill(CoordBBox(Coord(6, 6, 6), Coord(6, 6, 330)), true);
  mask.tree().fill(CoordBBox(Coord(6, 6, 330), Coord(20, 6, 330)), true);
  for (int x = 10; x <= 30; x += 2) {
    mask.tree().fill(CoordBBox(Coord(x, 6, 20), Coord(x, 6, 300)), true);
    const int z = x % 4 == 2 ? 300 : 20;
    mask.tree().fill(CoordBBox(Coord(x, 6, z), Coord(std::min(x + 2, 30), 6, z)), true);
  }
  mask.tree().fill(CoordBBox(Coord(6, 6, 20), Coord(10, 6, 20)), true);
  SegmentOptions options;
  options.gamma = 300;
  options.weights = VoxelWeights{};
  const Segmentation whole = segment(mask, options);
  REQUIRE(whole.counts.keptBalls < 4);
  std::vector<int> cuts;
  for (int z = 0; z <= 344; z += 8) cuts.push_back(z);
  const SlabObject object = cutObject(mask, cuts);
  CHECK(difference(whole, segmentCut(object, options)).empty());
  CHECK(difference(whole, segmentByMembers(object, options, 3)).empty());
  CHECK(difference(whole, segmentCut(cutObject(mask, {0, 40, 240, 344}), options)).empty());
}

TEST_CASE("slabs: what comes to a cut with the last round of a window goes on in the next",
          "[slabs]") {
  // A window of completion has 64 rounds. One ball and a fiber along z, so that each round covers
  // one voxel: in one of eight places round 64 covers the last one before a cut.
  SegmentOptions options;
  options.gamma = 300;
  options.weights = VoxelWeights{};
  for (const int direction : {-1, 1})
    for (int shift = 0; shift < 8; ++shift) {
      MaskGrid mask;
      const Coord center(8, 8, shift);
      for (auto p = CoordBBox::createCube(center.offsetBy(-6), 13).begin(); p; ++p)
        if ((*p - center).asVec3i().lengthSqr() <= 36) mask.tree().setValueOn(*p);
      for (int i = 0; i < 150; ++i) mask.tree().setValueOn(center.offsetBy(0, 0, direction * i));
      std::vector<int> cuts;
      for (int z = -160; z <= 168; z += 8) cuts.push_back(z);
      const Segmentation whole = segment(mask, options);
      REQUIRE(whole.counts.keptBalls == 1);
      CHECK(difference(whole, segmentCut(cutObject(mask, cuts), options)) == "");
    }
}

TEST_CASE("slabs: labels in regions are those of the whole", "[slabs]") {
  requireSameAsWhole(fromEnvironment("VDB_MADF_SEED", 1) + 300000,
                     fromEnvironment("VDB_MADF_CASES", 3 * kCombinations), 40, true);
}

TEST_CASE("slabs: an empty object has no grains, whatever the cuts", "[slabs]") {
  SegmentOptions options;
  options.domain = CoordBBox(Coord(0), Coord(20));
  const SlabSegmentation result = segmentCut(cutObject(MaskGrid(), {0, 8, 24}), options).result;
  CHECK(result.counts.objectVoxels == 0);
  CHECK(result.counts.grains == 0);
  CHECK(result.open);
  CHECK(segmentCut(cutObject(MaskGrid(), {0, 8, 24}), options).labels->activeVoxelCount() == 0);
}

TEST_CASE("slabs: weights follow from the edges and the whole object", "[slabs]") {
  SlabObject object = row(40, {0, 16, 40});
  const auto about = MaskGrid::create();
  about->setTransform(openvdb::math::Transform::Ptr(new openvdb::math::Transform(
      openvdb::math::MapBase::Ptr(new openvdb::math::ScaleMap(openvdb::Vec3d(0.5, 0.5, 1.2))))));
  object.about = about;
  CHECK(segmentCut(object, {}).result.weights == VoxelWeights{25, 25, 144});
  // Of a longer object there are others: 144 * 4000^2 does not fit.
  SlabObject tall = row(4000, {0, 1600, 4000});
  tall.about = about;
  MaskGrid whole;
  whole.tree().fill(CoordBBox(Coord(0), Coord(0, 0, 3999)), true);
  whole.setTransform(about->transformPtr());
  const Segmentation expected = segment(whole);
  CHECK(expected.weights != VoxelWeights{25, 25, 144});
  CHECK(segmentCut(tall, {}).result.weights == expected.weights);
}

TEST_CASE("slabs: what they do not know is refused", "[slabs]") {
  const SlabObject object = row(40, {0, 16, 40});
  SegmentOptions options;
  options.keepBalls = true;
  CHECK_THROWS_AS(segmentCut(object, options), InvalidInput);
  options = {};
  options.maxMemory = int64_t(1) << 40;
  CHECK_THROWS_AS(segmentCut(object, options), InvalidInput);
  options = {};
  options.autoStrictness = true;
  CHECK_THROWS_AS(segmentCut(object, options), InvalidInput);
  options = {};
  options.tidy = 9;  // more rounds than the slab in the middle has layers
  CHECK_THROWS_AS(segmentCut(row(40, {0, 16, 24, 40}), options), InvalidInput);
  options.tidy = 16;
  CHECK(segmentCut(row(40, {0, 8, 32, 40}), options).result.counts.grains == 1);

  SlabObject cut = row(40, {0, 16, 40});
  cut.cuts = {0, 12, 40};
  CHECK_THROWS_AS(segmentCut(cut, {}), InvalidInput);
  cut.cuts = {0, 40, 16};
  CHECK_THROWS_AS(segmentCut(cut, {}), InvalidInput);
}

namespace {

struct Killed {};

/// Stops after so many changes, and goes on from there when it is used again.
class MortalScratch : public MemoryScratch {
 public:
  int left = 0;
  void writeBytes(const std::string& name, const char* bytes, size_t size) override {
    if (left-- <= 0) throw Killed();
    MemoryScratch::writeBytes(name, bytes, size);
  }
  void remove(const std::string& name) override {
    if (!has(name)) return;
    if (left-- <= 0) throw Killed();
    MemoryScratch::remove(name);
  }
};

}  // namespace

TEST_CASE("slabs: what was stopped goes on to the same labels", "[slabs]") {
  for (const uint64_t seed : {104003u, 104011u, 104026u, 104031u}) {
    RandomCase c = randomCase(seed, Coord(7, 9, 44));
    c.kind = VolumeKind::ballUnion;
    Rng rng(seed);
    c.object = randomVolume(c.kind, boxAt({-3, 2, -20}, {7, 9, 44}), rng);
    c.domain = c.object.box();
    SegmentOptions options = c.options;
    options.boundary = Boundary::open;
    options.gamma = seed % 2 ? 20 : 0;
    options.keepManifold = true;
    options.tidy = 2;
    options.domain = domainOf(c);
    const SlabObject object = cutObject(*maskOf(c), {-24, -8, 0, 16, 24});
    const CutResult expected = segmentCut(object, options);
    // Stopped again and again. (What is done anew each time makes some 30 changes.)
    for (int every = 40; every < 200; every += every < 60 ? 1 : 13) {
      MortalScratch scratch;
      std::vector<SlabGrids> slabs(object.slabCount());
      CutResult cut;
      int runs = 0;
      for (bool done = false; !done && runs < 200; ++runs) {
        scratch.left = every;
        try {
          cut.result =
              segmentSlabs(object, options, scratch,
                           [&](size_t slab, const SlabGrids& grids) { slabs[slab] = grids; });
          done = true;
        } catch (const Killed&) {
        }
      }
      REQUIRE(runs < 200);
      joinSlabs(slabs, cut);
      REQUIRE(cut.result.grainVoxels == expected.result.grainVoxels);
      REQUIRE(cut.result.counts.medialBalls == expected.result.counts.medialBalls);
      REQUIRE(areSame(*cut.labels, *expected.labels));
      REQUIRE(areSame(*cut.manifolds, *expected.manifolds));
    }
  }
}

namespace {

/// What members share; all of them stop after so many changes.
struct SharedPieces {
  std::mutex mutex;
  MortalScratch pieces;
};

class SharedScratch : public Scratch {
 public:
  explicit SharedScratch(SharedPieces& all) : all_(all) {}
  void writeBytes(const std::string& name, const char* bytes, size_t size) override {
    const std::lock_guard<std::mutex> lock(all_.mutex);
    all_.pieces.writeBytes(name, bytes, size);
  }
  void readBytes(const std::string& name, const Allocate& allocate) const override {
    const std::lock_guard<std::mutex> lock(all_.mutex);
    all_.pieces.readBytes(name, allocate);
  }
  bool has(const std::string& name) const override {
    const std::lock_guard<std::mutex> lock(all_.mutex);
    return all_.pieces.has(name);
  }
  void remove(const std::string& name) override {
    const std::lock_guard<std::mutex> lock(all_.mutex);
    all_.pieces.remove(name);
  }
  bool isShared() const override { return true; }

 private:
  SharedPieces& all_;
};

}  // namespace

TEST_CASE("slabs: what was stopped with some members goes on with any number of them", "[slabs]") {
  const uint64_t first = fromEnvironment("VDB_MADF_SEED", 1) + 400000;
  const uint64_t cases = fromEnvironment("VDB_MADF_CASES", 150);
  int64_t stops = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed);
    RandomCase c =
        randomCase(seed, Coord(rng.between(1, 12), rng.between(1, 12), rng.between(16, 60)));
    if (rng.chance(0.3)) drawRegion(c);
    const MaskGrid::Ptr mask = maskOf(c);
    SegmentOptions options = optionsOf(c);
    options.domain = domainOf(c);
    options.keepDistance = options.keepPower = options.keepBalls = false;
    if (!options.weights) options.weights = VoxelWeights{};
    CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
    if (box.empty()) box = CoordBBox(Coord(0), Coord(7));
    SlabObject object;
    Segmentation whole;
    try {
      whole = segment(*mask, options);
      object = cutObject(*mask, randomCuts(box, rng));
      segmentCut(object, options);
    } catch (const std::exception&) {
      continue;  // the object leaves the domain, slabs are lower than `tidy` has rounds ...
    }
    SharedPieces all;
    CutResult cut;
    std::vector<SlabGrids> slabs(object.slabCount());
    int runs = 0;
    // Each time with more changes, so that it ends.
    for (bool done = false; !done; ++runs) {
      ThreadTeam team(rng.between(1, 4));
      all.pieces.left = 20 + 4 * runs + rng.below(60);
      try {
        asMembers(team, [&](Team& member) {
          SharedScratch scratch(all);
          SlabSegmentation result =
              segmentSlabs(object, options, scratch, member,
                           [&](size_t slab, const SlabGrids& grids) { slabs[slab] = grids; });
          if (member.member() == 0) cut.result = std::move(result);
        });
        done = true;
      } catch (const Killed&) {
      }
    }
    stops += runs - 1;
    joinSlabs(slabs, cut);
    INFO(describe(c) << runs << " runs");
    REQUIRE(difference(whole, cut) == "");
  }
  CHECK((cases < 100 || stops > int64_t(cases)));
}

TEST_CASE("slabs: a scratch that the members do not share, though it says so, is noticed",
          "[slabs]") {
  struct OwnScratch : MemoryScratch {
    bool isShared() const override { return true; }
  };
  ThreadTeam team(2);
  CHECK_THROWS_AS(asMembers(team,
                            [](Team& member) {
                              OwnScratch scratch;
                              segmentSlabs(row(40, {0, 16, 40}), {}, scratch, member,
                                           [](size_t, const SlabGrids&) {});
                            }),
                  IoError);
}

TEST_CASE("slabs: an interrupter stops them", "[slabs]") {
  MemoryScratch scratch;
  StopAtOnce stop;
  const auto ignore = [](size_t, const SlabGrids&) {};
  CHECK_THROWS_AS(segmentSlabs(row(40, {0, 16, 40}), {}, scratch, ignore, &stop), Interrupted);
}
