// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// segmentSlabs() against segment(), which is compared with the oracle, and what it refuses.
//
// The random comparison reads from the environment VDB_MADF_CASES (how many) and VDB_MADF_SEED (the
// first).

#include "vdb_madf/slabs/segment_slabs.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "support/random_case.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;

/// The leaves of a mask in slabs with these cuts.
SlabObject cutObject(const MaskGrid& mask, std::vector<int> cuts) {
  std::vector<std::vector<LeafIndex::LeafVoxels>> leaves(cuts.size() - 1);
  const LeafIndex index(mask);
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const auto above = std::upper_bound(cuts.begin(), cuts.end(), index.origin(leaf).z());
    if (above == cuts.begin() || above == cuts.end())
      throw std::logic_error("cuts leave the object");
    leaves[size_t(above - cuts.begin()) - 1].push_back({index.origin(leaf), index.mask(leaf)});
  }
  SlabObject object;
  object.cuts = std::move(cuts);
  object.leaves = [leaves](size_t slab) { return leaves[slab]; };
  object.about = openvdb::gridConstPtrCast<MaskGrid>(mask.copyGridWithNewTree());
  return object;
}

/// At every layer of leaves or some of them; now and then there are empty slabs at the ends.
std::vector<int> randomCuts(const CoordBBox& box, Rng& rng) {
  const int first = (box.min().z() & ~7) - 8 * rng.below(2);
  const int last = (box.max().z() | 7) + 1 + 8 * rng.below(2);
  std::vector<int> cuts{first};
  const double share = rng.chance(0.5) ? 1 : rng.unit();
  for (int z = first + 8; z < last; z += 8)
    if (rng.chance(share)) cuts.push_back(z);
  cuts.push_back(last);
  return cuts;
}

struct Cut {
  SlabSegmentation result;
  Int32Grid::Ptr labels;  ///< of all slabs; null without any
};

/// Adds the labels of a slab to those below it.
void addSlab(Int32Grid::Ptr& labels, const Int32Grid::Ptr& slab) {
  if (labels)
    labels->tree().merge(slab->tree());
  else
    labels = slab;
}

Cut segmentCut(const SlabObject& object, const SegmentOptions& options) {
  Cut cut;
  MemoryScratch scratch;
  size_t next = 0;
  cut.result =
      segmentSlabs(object, options, scratch, [&](size_t slab, const Int32Grid::Ptr& grain) {
        if (slab != next++) throw std::logic_error("slabs are put in another order");
        for (auto leaf = grain->tree().cbeginLeaf(); leaf; ++leaf)
          if (leaf->origin().z() < object.cuts[slab] || leaf->origin().z() >= object.cuts[slab + 1])
            throw std::logic_error("labels outside of their slab");
        addSlab(cut.labels, grain);
      });
  return cut;
}

/// Are they the same voxels, values and metadata?
bool areSame(const Int32Grid& a, const Int32Grid& b) {
  if (a.activeVoxelCount() != b.activeVoxelCount() || a.transform() != b.transform()) return false;
  const auto tree = b.getConstAccessor();
  for (auto voxel = a.cbeginValueOn(); voxel; ++voxel)
    if (tree.getValue(voxel.getCoord()) != *voxel) return false;
  if (a.metaCount() != b.metaCount()) return false;
  for (auto meta = a.beginMeta(); meta != a.endMeta(); ++meta)
    if (!b[meta->first] || *b[meta->first] != *meta->second) return false;
  return true;
}

std::string difference(const Segmentation& whole, const Cut& cut) {
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
  options.keepDistance = options.keepPower = options.keepManifold = options.keepBalls = false;
  options.gamma = 0;
  if (!options.weights) options.weights = VoxelWeights{};
  Rng rng(c.seed);
  CoordBBox box = c.domain ? *c.domain : mask->evalActiveVoxelBoundingBox();
  if (box.empty()) box = CoordBBox(Coord(0), Coord(7));
  Comparison result;
  std::string refused, refusedCut;
  Segmentation whole;
  Cut cut;
  try {
    whole = segment(*mask, options);
  } catch (const InvalidInput& e) {
    refused = e.what();
  }
  try {
    const SlabObject object = cutObject(*mask, randomCuts(box, rng));
    for (size_t s = 0; s < object.slabCount(); ++s) result.slabs += !object.leaves(s).empty();
    cut = withThreads(c.threads, [&] { return segmentCut(object, options); });
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

/// Compares that many volumes, tall ones if `height` is given.
void requireSame(uint64_t first, uint64_t cases, int height) {
  uint64_t compared = 0, several = 0;
  for (uint64_t seed = first; seed < first + cases; ++seed) {
    Rng rng(seed + 9000);
    std::optional<Coord> size;
    if (height > 0) size = Coord(rng.between(1, 12), rng.between(1, 12), rng.between(16, height));
    const RandomCase c = randomCase(seed, size);
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
  CHECK(several > (height > 0 ? cases / 2 : cases / 4));
}

/// A row of voxels along z.
SlabObject row(int length, std::vector<int> cuts) {
  MaskGrid mask;
  mask.tree().fill(CoordBBox(Coord(0), Coord(0, 0, length - 1)), true);
  return cutObject(mask, std::move(cuts));
}

}  // namespace

TEST_CASE("slabs: labels and counts are those of the whole", "[slabs]") {
  requireSame(fromEnvironment("VDB_MADF_SEED", 1),
              fromEnvironment("VDB_MADF_CASES", 37 * kCombinations), 0);
}

TEST_CASE("slabs: labels and counts of tall objects are those of the whole", "[slabs]") {
  requireSame(fromEnvironment("VDB_MADF_SEED", 1) + 100000,
              fromEnvironment("VDB_MADF_CASES", 28 * kCombinations), 90);
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
  options.gamma = 20;
  CHECK_THROWS_AS(segmentCut(object, options), InvalidInput);
  options = {};
  options.keepBalls = true;
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

  MaskTree shell;
  shell.fill(CoordBBox(Coord(0), Coord(0, 0, 39)), true);
  shell.setValueOff(Coord(0, 0, 20));
  options = {};
  options.domain = Domain(shell);
  CHECK_THROWS_AS(segmentCut(object, options), InvalidInput);
}

namespace {

struct Killed {};

/// Stops after so many changes, and goes on from there when it is used again.
class MortalScratch : public MemoryScratch {
 public:
  int left = 0;
  void write(const std::string& name, const std::vector<char>& bytes) override {
    if (left-- <= 0) throw Killed();
    MemoryScratch::write(name, bytes);
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
    options.gamma = 0;
    options.tidy = 2;
    options.domain = domainOf(c);
    const SlabObject object = cutObject(*maskOf(c), {-24, -8, 0, 16, 24});
    const Cut expected = segmentCut(object, options);
    // Stopped again and again. (A step that is done makes four changes at most.)
    for (int every = 4; every < 60; every += every < 16 ? 1 : 7) {
      MortalScratch scratch;
      std::vector<Int32Grid::Ptr> slabs(object.slabCount());
      SlabSegmentation result;
      int runs = 0;
      for (bool done = false; !done && runs < 200; ++runs) {
        scratch.left = every;
        try {
          result =
              segmentSlabs(object, options, scratch,
                           [&](size_t slab, const Int32Grid::Ptr& grain) { slabs[slab] = grain; });
          done = true;
        } catch (const Killed&) {
        }
      }
      Int32Grid::Ptr labels;
      for (const Int32Grid::Ptr& slab : slabs) addSlab(labels, slab);
      REQUIRE(runs < 200);
      REQUIRE(result.grainVoxels == expected.result.grainVoxels);
      REQUIRE(result.counts.medialBalls == expected.result.counts.medialBalls);
      REQUIRE(areSame(*labels, *expected.labels));
    }
  }
}

TEST_CASE("slabs: an interrupter stops them", "[slabs]") {
  MemoryScratch scratch;
  StopAtOnce stop;
  const auto ignore = [](size_t, const Int32Grid::Ptr&) {};
  CHECK_THROWS_AS(segmentSlabs(row(40, {0, 16, 40}), {}, scratch, ignore, &stop), Interrupted);
}
