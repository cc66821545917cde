// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/preview_volume.h"
#include "vdb_madf/labels/reduced_labels.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/grain_colors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

int below(int a, int factor) {
  return int(std::floor(double(a) / factor));
}

/// Voxels of each label in each coarse voxel.
std::map<Coord, std::map<int32_t, int>> counted(const LabelMap& voxels, int factor) {
  std::map<Coord, std::map<int32_t, int>> cells;
  for (const auto& [p, label] : voxels)
    ++cells[{below(p.x(), factor), below(p.y(), factor), below(p.z(), factor)}][label];
  return cells;
}

/// The most frequent; the smallest of those.
int32_t mode(const std::map<int32_t, int>& counts) {
  int32_t best = -1;
  int most = 0;
  for (const auto& [label, count] : counts)
    if (count > most) {
      best = label;
      most = count;
    }
  return best;
}

}  // namespace

TEST_CASE("label_preview: reduced labels are the most frequent ones", "[label_preview]") {
  for (const int factor : {1, 2, 3, 8, 11}) {
    CAPTURE(factor);
    const LabelMap voxels = randomLabels(unsigned(factor), Coord(-13, -7, 4), 23, 3, 70);
    const auto reduced = reduceLabels(*labelGrid(voxels), factor);
    size_t expectedActive = 0;
    for (auto& [p, counts] : counted(voxels, factor)) {
      auto all = counts;
      int labelled = 0;
      for (const auto& [label, count] : counts) labelled += count;
      all[0] = factor * factor * factor - labelled;
      const int32_t expected = mode(all);
      expectedActive += expected > 0;
      CHECK(reduced->tree().getValue(p) == expected);
      CHECK(reduced->tree().isValueOn(p) == (expected > 0));
    }
    CHECK(reduced->activeVoxelCount() == expectedActive);
  }
}

TEST_CASE("label_preview: ties go to the smaller id, background included", "[label_preview]") {
  LabelMap voxels;
  for (int n = 0; n < 4; ++n) voxels[{0, n >> 1, n & 1}] = 9;  // half of one coarse voxel
  for (int n = 0; n < 8; ++n) voxels[{2 + (n >> 2), n >> 1 & 1, n & 1}] = n < 4 ? 8 : 5;
  const auto reduced = reduceLabels(*labelGrid(voxels), 2);
  CHECK(!reduced->tree().isValueOn({0, 0, 0}));
  CHECK(reduced->tree().getValue({1, 0, 0}) == 5);
}

TEST_CASE("label_preview: of a region those coarse voxels are left that are half in it",
          "[label_preview]") {
  for (const int factor : {2, 3, 8, 11, 20}) {
    CAPTURE(factor);
    // Noise, and tiles of both sizes that the coarse voxels cut.
    LabelMap voxels = randomLabels(unsigned(factor), Coord(-13, -7, 4), 23, 3, 50);
    const auto labels = labelGrid(voxels);
    MaskTree region(labels->tree(), false, true, openvdb::TopologyCopy());
    region.addTile(1, Coord(24, 8, 0), true, true);
    region.addTile(2, Coord(0, 128, 0), true, true);
    setDomain(*labels, Domain(region));
    std::map<Coord, int> fine;
    const CoordBBox box = Domain(region).box();
    for (auto p = box.begin(); p != box.end(); ++p) {
      if (!region.isValueOn(*p)) continue;
      Coord coarse = *p;
      for (int axis = 0; axis < 3; ++axis)
        coarse[axis] = int(std::floor(double((*p)[axis]) / factor));
      ++fine[coarse];
    }
    const auto domain = storedDomain(*reduceLabels(*labels, factor));
    REQUIRE(domain);
    int64_t inside = 0;
    for (const auto& [coarse, count] : fine) {
      CoordBBox part = CoordBBox::createCube(
          Coord(coarse.x() * factor, coarse.y() * factor, coarse.z() * factor), factor);
      part.intersect(box);
      const bool isIn = 2 * count >= int(part.volume());
      inside += isIn;
      CHECK(domain->isInside(coarse) == isIn);
    }
    CHECK(domain->voxelCount() == inside);
  }
}

TEST_CASE("label_preview: density is the labeled part, color that of the commonest label",
          "[label_preview]") {
  for (const int factor : {1, 2, 5}) {
    const LabelMap voxels = randomLabels(7, Coord(-6), 17, 9, 60);
    const auto grid = labelGrid(voxels);
    const GrainColors colors = grainColors(*grid);
    const LabelPreview preview = previewLabels(*grid, factor);
    // Beyond a box there is nothing that a voxel could be part of.
    const CoordBBox box = CoordBBox::createCube(Coord(-6), 17);
    const auto withBox = grid->deepCopy();
    setDomain(*withBox, box);
    const LabelPreview inBox = previewLabels(*withBox, factor);
    std::map<Coord, int> known;
    for (auto p = box.begin(); p; ++p)
      ++known[{below((*p).x(), factor), below((*p).y(), factor), below((*p).z(), factor)}];
    const auto cells = counted(voxels, factor);
    CHECK(preview.density->activeVoxelCount() == cells.size());
    CHECK(preview.color->activeVoxelCount() == cells.size());
    for (const auto& [p, counts] : cells) {
      int labelled = 0;
      for (const auto& [label, count] : counts) labelled += count;
      CHECK(preview.density->tree().getValue(p) ==
            Approx(double(labelled) / (factor * factor * factor)));
      CHECK(inBox.density->tree().getValue(p) == Approx(double(labelled) / known.at(p)));
      const Rgb rgb = colors.colorOf(mode(counts));
      const openvdb::Vec3f color = preview.color->tree().getValue(p);
      for (int c = 0; c < 3; ++c) {
        // Back to sRGB.
        const double l = double(color[c]);
        const double s = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
        CHECK(255 * s == Approx(double(rgb[size_t(c)])).margin(0.01));
      }
    }
  }
}

TEST_CASE("label_preview: grids are what renderers take", "[label_preview]") {
  const auto grid = labelGrid(twoBalls({0, 0, 0}, 5));
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  setDomain(*grid, CoordBBox(Coord(-9), Coord(20)));
  const LabelPreview preview = previewLabels(*grid, 3);
  CHECK(preview.density->getName() == "density");
  CHECK(preview.density->getGridClass() == openvdb::GRID_FOG_VOLUME);
  CHECK(preview.color->getName() == "color");
  CHECK(preview.color->getVectorType() == openvdb::VEC_INVARIANT);
  CHECK(preview.color->transform() == preview.density->transform());
  CHECK(storedVoxelSize(*preview.density)->edge() == Approx(25.5e-6));
  setVoxelSize(*grid, VoxelSize({1e-6, 1e-6, 2e-6}));
  CHECK(storedVoxelSize(*previewLabels(*grid, 3).density)->edges()[2] == Approx(6e-6));
  CHECK(*storedDomain(*preview.density) == CoordBBox(Coord(-3), Coord(6)));
  CHECK(reduceLabels(*grid, 3)->getName() == "grain");
}

TEST_CASE("label_preview: a coarse voxel lies at the middle of its voxels", "[label_preview]") {
  for (const int factor : {2, 3, 8}) {
    LabelMap voxels;
    const Coord corner(-3 * factor, 5 * factor, 2 * factor);
    for (int x = 0; x < factor; ++x)
      for (int y = 0; y < factor; ++y)
        for (int z = 0; z < factor; ++z) voxels[corner.offsetBy(x, y, z)] = 4;
    const auto grid = labelGrid(voxels);
    setVoxelSize(*grid, VoxelSize{2e-6});
    const auto reduced = reduceLabels(*grid, factor);
    REQUIRE(reduced->activeVoxelCount() == 1);
    const openvdb::Vec3d found = reduced->indexToWorld(reduced->cbeginValueOn().getCoord());
    const openvdb::Vec3d wanted =
        0.5 * (grid->indexToWorld(corner) + grid->indexToWorld(corner.offsetBy(factor - 1)));
    for (int axis = 0; axis < 3; ++axis) CHECK(found[axis] == Approx(wanted[axis]));
  }
}

TEST_CASE("label_preview: the reduction for a size is the smallest that does", "[label_preview]") {
  for (const auto& [low, high, most] :
       {std::tuple{0, 9, 10}, {0, 10, 10}, {-1, 8, 5}, {-7, 92, 9}}) {
    const CoordBBox box{Coord(low), Coord(high)};
    const int factor = reductionFor(box, most);
    CHECK(below(high, factor) - below(low, factor) < most);
    for (int smaller = 1; smaller < factor; ++smaller)
      CHECK(below(high, smaller) - below(low, smaller) >= most);
  }
  CHECK(reductionFor({}, 5) == 1);
  CHECK_THROWS_AS(reductionFor({Coord(0), Coord(1000)}, 0), InvalidInput);
  CHECK_THROWS_AS(reductionFor({Coord(0), Coord(1000)}, 3), InvalidInput);
  CHECK_THROWS_AS(reduceLabels(*labelGrid({}), 0), InvalidInput);
  CHECK(reduceLabels(*labelGrid({}), 4)->empty());
}

TEST_CASE("label_preview: same for any number of threads and with tiles", "[label_preview]") {
  LabelMap voxels = randomLabels(8, Coord(-20), 16, 5, 70);
  for (int x = 0; x < 24; ++x)
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) voxels[{x, y, z}] = 2;
  const auto grid = labelGrid(voxels);
  const auto expected = reduceLabels(*grid, 3);
  const auto tiled = grid->deepCopy();
  tiled->pruneGrid();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto other = reduceLabels(*tiled, 3);
  CHECK(other->activeVoxelCount() == expected->activeVoxelCount());
  for (auto voxel = expected->cbeginValueOn(); voxel; ++voxel)
    CHECK(other->tree().getValue(voxel.getCoord()) == *voxel);
}
