// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/reduced_labels.h"

#include <algorithm>
#include <map>
#include <random>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

Coord coarseOf(const Coord& p, int factor) {
  const auto part = [&](int x) { return x >= 0 ? x / factor : -((factor - 1 - x) / factor); };
  return {part(p.x()), part(p.y()), part(p.z())};
}

/// What reduceLabels() promises, by counting.
LabelMap reducedByCounting(const LabelMap& voxels, int factor, const CoordBBox& domain) {
  std::map<Coord, std::map<int32_t, int>> counts;
  for (const auto& [p, label] : voxels) ++counts[coarseOf(p, factor)][label];
  for (auto p = domain.begin(); p; ++p)
    if (voxels.count(*p) == 0) ++counts[coarseOf(*p, factor)][0];
  LabelMap reduced;
  for (auto& [coarse, count] : counts) {
    const auto most =
        std::max_element(count.begin(), count.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->first) reduced[coarse] = most->first;
  }
  return reduced;
}

}  // namespace

TEST_CASE("reduced_labels: each coarse voxel has the most frequent label", "[reduced_labels]") {
  for (const int factor : {1, 2, 3, 5})
    for (unsigned seed = 0; seed < 6; ++seed) {
      CAPTURE(factor, seed);
      const LabelMap voxels =
          randomLabels(seed, Coord(-9, 20, -5), 21, 1 + int(seed % 3), 40 + 10 * int(seed));
      const auto labels = labelGrid(voxels);
      CoordBBox domain(Coord(-9, 20, -5), Coord(11, 40, 15));
      if (seed % 2 == 0) domain.expand(factor);  // else voxels beyond it are no background
      setDomain(*labels, domain);
      const auto reduced = reduceLabels(*labels, factor);
      const LabelMap expected = reducedByCounting(voxels, factor, domain);
      CHECK(reduced->activeVoxelCount() == expected.size());
      for (const auto& [p, label] : expected) REQUIRE(reduced->tree().getValue(p) == label);
      // The same of slabs, which leaves labels as they are that are in memory.
      const auto again = reduceLabels(singleSlab(labels), factor);
      CHECK(again->activeVoxelCount() == expected.size());
      CHECK(labels->activeVoxelCount() == voxels.size());
    }
}

TEST_CASE("reduced_labels: a region keeps the coarse voxels of which it has half in its box",
          "[reduced_labels]") {
  for (const int factor : {2, 3}) {
    MaskTree region;
    region.sparseFill(CoordBBox(Coord(-3, -9, 1), Coord(30, 14, 29)), true, true);  // has tiles
    region.sparseFill(CoordBBox::createCube(Coord(64), 8), true, true);  // a tile by itself
    REQUIRE(region.activeTileCount() > 1);
    std::mt19937 random(4);
    for (int i = 0; i < 3000; ++i)
      region.setValueOn(Coord(31 + int(random() % 9), int(random() % 20), int(random() % 20)));
    LabelMap voxels;
    std::map<Coord, int> counts;
    for (auto voxel = region.cbeginValueOn(); voxel; ++voxel) {
      const CoordBBox box = voxel.getBoundingBox();
      for (auto p = box.begin(); p != box.end(); ++p) {
        ++counts[coarseOf(*p, factor)];
        voxels[*p] = 1;
      }
    }
    const auto labels = labelGrid(voxels);
    setDomain(*labels, Domain(region));
    const auto reduced = reduceLabels(*labels, factor);
    const auto domain = storedDomain(*reduced);
    REQUIRE(domain);
    int inside = 0;
    for (const auto& [coarse, count] : counts) {
      CAPTURE(factor, coarse, count);
      CoordBBox fine = CoordBBox::createCube(
          Coord(coarse.x() * factor, coarse.y() * factor, coarse.z() * factor), factor);
      fine.intersect(Domain(region).box());
      REQUIRE(domain->isInside(coarse) == (2 * count >= int(fine.volume())));
      inside += domain->isInside(coarse);
    }
    CHECK(int(domain->voxelCount()) == inside);
    for (auto voxel = reduced->cbeginValueOn(); voxel; ++voxel)
      REQUIRE(domain->isInside(voxel.getCoord()));
  }
}

TEST_CASE("reduced_labels: places are in the unit of the coarse voxels", "[reduced_labels]") {
  const auto labels = labelGrid({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 1, 0}, 1}, {{0, 0, 1}, 1}});
  setVoxelSize(*labels, VoxelSize(1e-8));  // of um; below 20 nm
  setDomain(*labels, CoordBBox(Coord(0), Coord(1)));
  const auto reduced = reduceLabels(*labels, 2);
  REQUIRE(storedVoxelSize(*reduced)->unit() == "mm");
  CHECK((*reduced)["madf_length_unit"]->str() == "mm");
  CHECK(reduced->voxelSize().x() == Approx(2e-5));
  CHECK(reduced->indexToWorld(Coord(0)).z() == Approx(5e-6));
  const auto fine = transformInUnitOf(*labels, *reduced);
  CHECK(fine->voxelSize().x() == Approx(0.02));
  CHECK(fine->indexToWorld(Coord(0)).z() == Approx(0.005));
}

TEST_CASE("label_blocks: the voxels of each label are counted", "[label_blocks]") {
  const LabelMap voxels = randomLabels(2, Coord(-6, 3, -9), 19, 5, 60);
  std::map<int32_t, int64_t> expected;
  for (const auto& [p, label] : voxels) ++expected[label];
  const detail::LabelBlocks blocks(*labelGrid(voxels));
  std::map<int32_t, int64_t> counted;
  for (size_t i = 0; i < blocks.labels().size(); ++i)
    counted[blocks.labels()[i]] = blocks.voxelCounts()[i];
  CHECK(counted == expected);
}
