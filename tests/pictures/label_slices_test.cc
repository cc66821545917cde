// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// What a pixel must show, by the definition: voxel (right, down) of the slice.
Rgb expected(const LabelMap& voxels, const GrainColors& colors, const Coord& p, const Rgb& empty) {
  const auto found = voxels.find(p);
  return found == voxels.end() ? empty : colors.colorOf(found->second);
}

const CoordBBox kBox(Coord(-3, 2, -9), Coord(9, 12, 4));  // 13, 11, 14 voxels

/// Pictures of the three planes through the middle of kBox, of voxels with these edges.
void requireMiddlePlanes(const LabelSlices& slices, const LabelMap& voxels,
                         const GrainColors& colors, const std::array<double, 3>& edges,
                         double scale) {
  const Coord middle(3, 7, -3);
  CHECK(slices.voxelsPerPixel == scale);
  const int axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (size_t i = 0; i < 3; ++i) {
    const int right = axes[i][0], down = axes[i][1];
    const Picture& picture = slices.pictures[i];
    const auto pixels = [&](int axis) {
      return int(std::ceil(kBox.extents()[axis] * edges[size_t(axis)] / scale));
    };
    REQUIRE(picture.width == pixels(right));
    REQUIRE(picture.height == pixels(down));
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const int column = int(x * scale / edges[size_t(right)]),
                  row = int(y * scale / edges[size_t(down)]);
        Coord p = middle;
        p[right] = kBox.min()[right] + column;
        p[down] = down == 2 ? kBox.max().z() - row : kBox.min()[down] + row;
        REQUIRE(picture.at(x, y) == expected(voxels, colors, p, Rgb{18, 20, 26}));
      }
  }
}

}  // namespace

TEST_CASE("label_slices: pixels are the voxels of the middle planes", "[label_slices]") {
  const LabelMap voxels = randomLabels(3, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  for (const auto& [longest, scale] :
       {std::pair<int, double>{14, 1}, {13, 2}, {43, 1 / 3.0}, {4, 4}}) {
    CAPTURE(longest);
    const LabelSlices slices = middleSlices(*labels, kBox, grainColors(*labels), longest);
    requireMiddlePlanes(slices, voxels, grainColors(*labels), {1, 1, 1}, scale);
    for (const Picture& picture : slices.pictures)
      CHECK(std::max(picture.width, picture.height) <= longest);
  }
}

TEST_CASE("label_slices: unequal voxels are shown in true proportions", "[label_slices]") {
  const LabelMap voxels = randomLabels(4, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  setVoxelSize(*labels, VoxelSize({2e-6, 1e-6, 2.5e-6}));  // 26 x 11 x 35 of the shortest edge
  for (const auto& [longest, scale] : {std::pair<int, double>{35, 1}, {80, 0.5}, {12, 3}}) {
    CAPTURE(longest);
    const LabelSlices slices = middleSlices(*labels, kBox, grainColors(*labels), longest);
    requireMiddlePlanes(slices, voxels, grainColors(*labels), {2, 1, 2.5}, scale);
  }
}

TEST_CASE("label_slices: tiles are shown, inactive values are not", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  labels->tree().addTile(1, Coord(0), 5, true);
  labels->tree().addTile(1, Coord(8, 0, 0), 6, false);
  const GrainColors colors = grainColors(*labels);
  const LabelSlices slices =
      middleSlices(*labels, CoordBBox(Coord(0), Coord(15, 7, 7)), colors, 16);
  CHECK(slices.pictures[0].at(7, 7) == colors.colorOf(5));
  CHECK(slices.pictures[0].at(8, 7) == Rgb{18, 20, 26});
}

TEST_CASE("label_slices: an empty box or picture is refused", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  CHECK_THROWS_AS(middleSlices(*labels, CoordBBox(), {}), InvalidInput);
  CHECK_THROWS_AS(middleSlices(*labels, CoordBBox(Coord(0), Coord(3)), {}, 0), InvalidInput);
}
