// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What a slab offers to others, of the distances near its cuts, against the same of the distances
// of the whole object.

#include "vdb_madf/slabs/cuts/near_cuts.h"

#include <algorithm>
#include <array>
#include <vector>

#include "support/catch.h"
#include "support/random_volume.h"
#include "support/slab_objects.h"
#include "vdb_madf/method/kernels/distance_rows.h"
#include "vdb_madf/method/squared_distance.h"

namespace {

using namespace vdb_madf;
using namespace vdb_madf::test;
using detail::ColumnSteps;
using detail::Cut;
using detail::ForeignSite;
using detail::SlabFaces;

struct TallObject {
  ObjectVolume voxels;
  Obstacles obstacles;
  VoxelWeights weights;
};

/// Wide and thick enough for balls that reach further than the first layers at a cut, now and then.
TallObject randomObject(Rng& rng) {
  static constexpr VolumeKind kKinds[] = {VolumeKind::ballUnion,  VolumeKind::fullBlock,
                                          VolumeKind::roughBalls, VolumeKind::boxUnion,
                                          VolumeKind::thinRods,   VolumeKind::pinholes,
                                          VolumeKind::denseNoise, VolumeKind::blurredNoise};
  const bool isWide = rng.chance(0.4);
  const int side = isWide ? rng.between(60, 100) : rng.between(1, 24);
  const VolumeKind kind = isWide && rng.chance(0.5) ? VolumeKind::fullBlock : kKinds[rng.below(8)];
  // One after another, so that each compiler draws the same objects.
  const int height = rng.between(80, 260);
  const int bottom = rng.between(-30, 30);
  const CoordBBox box = boxAt(Coord(-3, 5, bottom), Coord(side, side + 2, height));
  TallObject object{randomVolume(kind, box, rng), {}, {}};
  object.voxels[box.min() + Coord(side / 2, side / 2, rng.below(80))] = 0;  // never all of it
  object.obstacles.open = rng.chance(0.5);
  object.obstacles.domain = box;
  if (rng.chance(0.5)) object.weights = {rng.between(1, 5), rng.between(1, 5), rng.between(1, 5)};
  return object;
}

LeafIndex leavesBetween(const LeafIndex& index, int begin, int end) {
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (index.origin(leaf).z() >= begin && index.origin(leaf).z() < end)
      leaves.push_back({index.origin(leaf), index.mask(leaf)});
  return {LeafIndex(), leaves};
}

/// How many object voxels follow each other in the columns of the leaves at `leafZ`, from z on by
/// step.
ColumnSteps countSteps(const TallObject& object, const LeafIndex& index, int leafZ, int z,
                       int step) {
  const auto countFrom = [&](Coord p) {
    uint32_t count = 0;
    for (; object.voxels.get(p, 0); p.z() += step) ++count;
    const bool isUnknown = object.obstacles.open && !object.obstacles.domain.box().isInside(p);
    return isUnknown ? detail::kInfinite : count;
  };
  ColumnSteps steps;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const Coord& origin = index.origin(leaf);
    if (origin.z() != leafZ) continue;
    ColumnSteps::Rows rows{};
    for (int row = 0; row < 64; ++row)
      rows[size_t(row)] = countFrom({origin.x() + row / 8, origin.y() + row % 8, z});
    steps.add(origin, rows);
  }
  return steps;
}

SlabFaces facesOf(const TallObject& object, const LeafIndex& index, int begin, int end) {
  SlabFaces faces;
  faces.begin = begin;
  faces.end = end;
  faces.hasBelow = faces.hasAbove = true;
  faces.below = countSteps(object, index, begin - 8, begin - 1, -1);
  faces.above = countSteps(object, index, end, end, 1);
  return faces;
}

VoxelArray<int32_t> restricted(const VoxelArray<int32_t>& values, const LeafIndex& whole,
                               const LeafIndex& slab) {
  VoxelArray<int32_t> result(size_t(slab.voxelCount()));
  for (size_t leaf = 0; leaf < slab.leafCount(); ++leaf)
    std::copy_n(values.data() + whole.firstRank(*whole.findLeaf(slab.origin(leaf))),
                slab.leafVoxels(leaf), result.data() + slab.firstRank(leaf));
  return result;
}

std::vector<std::array<int, 4>> toNumbers(const std::vector<ForeignSite>& sites) {
  std::vector<std::array<int, 4>> numbers;
  for (const ForeignSite& site : sites) {
    const Coord& p = site.position;
    numbers.push_back({p.x(), p.y(), p.z(), site.squaredRadius});
  }
  return numbers;
}

}  // namespace

TEST_CASE("near cuts: distances there tell all balls that reach beyond a cut", "[near_cuts]") {
  size_t sites = 0, deep = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    CAPTURE(seed);
    Rng rng(seed);
    const TallObject object = randomObject(rng);
    const LeafIndex index(*toMask(object.voxels));
    if (index.voxelCount() == 0) continue;
    const SquaredDistance whole = squaredDistance(index, object.obstacles, object.weights);
    const CoordBBox& box = object.voxels.box();
    // The slab may begin, or end, beyond the domain.
    const int begin = (box.min().z() + rng.between(-10, 40)) & ~7;
    const int end = std::max((box.max().z() + rng.between(-40, 10)) & ~7, begin + 8);
    const LeafIndex slab = leavesBetween(index, begin, end);
    const SlabFaces faces = facesOf(object, index, begin, end);
    const auto distance = restricted(whole.values, index, slab);
    detail::NearCuts cuts(slab, object.obstacles, object.weights, faces, nullptr);
    for (const bool isUpper : {true, false}) {
      CAPTURE(isUpper);
      const auto expected =
          toNumbers(siteOffers(slab, distance, object.weights.z, Cut{begin, end, isUpper}));
      const bool areSame = toNumbers(cuts.offers(isUpper)) == expected;
      REQUIRE(areSame);
      for (const auto& site : expected)
        deep += (isUpper ? end - site[2] : site[2] - begin + 1) > 32;
      sites += expected.size();
    }
  }
  CHECK(sites > 10000);
  CHECK(deep > 100);  // balls that lie deeper than the layers that are looked at first
}
