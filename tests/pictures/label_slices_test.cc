// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <catch2/catch.hpp>

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

}  // namespace

TEST_CASE("label_slices: pixels are the voxels of the middle planes", "[label_slices]") {
  const CoordBBox box(Coord(-3, 2, -9), Coord(9, 12, 4));  // 13, 11, 14 voxels
  const LabelMap voxels = randomLabels(3, box.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  const GrainColors colors = grainColors(*labels);
  const Coord middle(3, 7, -3);
  for (const auto& [edge, scale] :
       {std::pair<int, double>{14, 1}, {13, 2}, {43, 1 / 3.0}, {4, 4}}) {
    CAPTURE(edge);
    const LabelSlices slices = middleSlices(*labels, box, colors, edge);
    CHECK(slices.voxelsPerPixel == scale);
    const int axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (size_t i = 0; i < 3; ++i) {
      const auto [right, down] = axes[i];
      const Picture& picture = slices.pictures[i];
      const auto pixels = [&](int axis) { return int(std::ceil(box.extents()[axis] / scale)); };
      REQUIRE(picture.width == pixels(right));
      REQUIRE(picture.height == pixels(down));
      CHECK(std::max(picture.width, picture.height) <= edge);
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          Coord p = middle;
          p[right] = box.min()[right] + int(x * scale);
          p[down] = down == 2 ? box.max().z() - int(y * scale) : box.min()[down] + int(y * scale);
          REQUIRE(picture.at(x, y) == expected(voxels, colors, p, Rgb{18, 20, 26}));
        }
    }
  }
}

TEST_CASE("label_slices: unequal voxels are shown in true proportions", "[label_slices]") {
  const CoordBBox box(Coord(-3, 2, -9), Coord(9, 12, 4));  // 13, 11, 14 voxels
  const LabelMap voxels = randomLabels(4, box.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  setVoxelSize(*labels, VoxelSize({2e-6, 1e-6, 2.5e-6}));
  const double edges[3] = {2, 1, 2.5};  // 26 x 11 x 35
  const GrainColors colors = grainColors(*labels);
  const Coord middle(3, 7, -3);
  for (const auto& [edge, scale] : {std::pair<int, double>{35, 1}, {80, 0.5}, {12, 3}}) {
    CAPTURE(edge);
    const LabelSlices slices = middleSlices(*labels, box, colors, edge);
    CHECK(slices.voxelsPerPixel == scale);
    const int axes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (size_t i = 0; i < 3; ++i) {
      const auto [right, down] = axes[i];
      const Picture& picture = slices.pictures[i];
      const auto pixels = [&](int axis) {
        return int(std::ceil(box.extents()[axis] * edges[axis] / scale));
      };
      REQUIRE(picture.width == pixels(right));
      REQUIRE(picture.height == pixels(down));
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
          const int column = int(x * scale / edges[right]), row = int(y * scale / edges[down]);
          Coord p = middle;
          p[right] = box.min()[right] + column;
          p[down] = down == 2 ? box.max().z() - row : box.min()[down] + row;
          REQUIRE(picture.at(x, y) == expected(voxels, colors, p, Rgb{18, 20, 26}));
        }
    }
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
