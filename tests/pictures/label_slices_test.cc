// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/pictures/label_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

const CoordBBox kBox(Coord(-3, 2, -9), Coord(9, 12, 4));  // 13, 11, 14 voxels
constexpr Rgb kEmpty{243, 244, 246}, kPale{206, 209, 214};

using ColorAt = std::function<Rgb(const Coord&)>;

/// Pixels of the planes x = 3, y = 7, z = -3 of kBox that lie within one voxel show its color; the
/// others colors between those of the voxels that they meet.
/// @param edges of a voxel
void requirePlanes(const LabelSlices& slices, const std::array<double, 3>& edges, double scale,
                   const ColorAt& colorAt) {
  CHECK(slices.voxelsPerPixel == Approx(scale));
  REQUIRE(slices.pictures.size() == slices.planes.size());
  for (size_t i = 0; i < slices.planes.size(); ++i) {
    const SlicePlane plane = slices.planes[i];
    const int right = plane.right(), down = plane.down();
    const Picture& picture = slices.pictures[i];
    const auto pixels = [&](int axis) {
      return int(std::ceil(kBox.extents()[axis] * edges[size_t(axis)] / scale - 1e-6));
    };
    REQUIRE(picture.width == pixels(right));
    REQUIRE(picture.height == pixels(down));
    const auto voxels = [&](int pixel, int axis) {
      const double size = edges[size_t(axis)];
      const int last = kBox.extents()[axis] - 1;
      return std::pair<int, int>(std::min(last, int(pixel * scale / size + 1e-9)),
                                 std::min(last, int((pixel + 1) * scale / size - 1e-9)));
    };
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto [left, rightmost] = voxels(x, right);
        const auto [top, bottom] = voxels(y, down);
        Rgb low{255, 255, 255}, high{0, 0, 0};
        for (int row = top; row <= bottom; ++row)
          for (int column = left; column <= rightmost; ++column) {
            Coord p;
            p[plane.axis] = plane.index;
            p[right] = kBox.min()[right] + column;
            p[down] = down == 2 ? kBox.max().z() - row : kBox.min()[down] + row;
            const Rgb color = colorAt(p);
            for (size_t c = 0; c < 3; ++c) {
              low[c] = std::min(low[c], color[c]);
              high[c] = std::max(high[c], color[c]);
            }
          }
        for (size_t c = 0; c < 3; ++c) {
          REQUIRE(picture.at(x, y)[c] >= low[c]);
          REQUIRE(picture.at(x, y)[c] <= high[c]);
        }
      }
  }
}

ColorAt filled(const LabelMap& voxels, const GrainColors& colors) {
  return [&voxels, &colors](const Coord& p) {
    const auto found = voxels.find(p);
    return found == voxels.end() ? kEmpty : colors.colorOf(found->second);
  };
}

LabelSlices slicesOf(const Int32Grid& labels, int edge) {
  SliceOptions options;
  options.edge = edge;
  return labelSlices(labels, kBox, grainColors(labels), options);
}

}  // namespace

TEST_CASE("label_slices: pixels are the voxels of the middle planes", "[label_slices]") {
  const LabelMap voxels = randomLabels(3, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  const GrainColors colors = grainColors(*labels);
  for (const int edge : {14, 13, 42, 43, 4}) {
    CAPTURE(edge);
    const LabelSlices slices = slicesOf(*labels, edge);
    REQUIRE(slices.planes.size() == 3);
    CHECK(slices.planes[0].axis == 2);
    CHECK(slices.planes[0].index == -3);
    CHECK(slices.planes[1].index == 7);
    CHECK(slices.planes[2].index == 3);
    requirePlanes(slices, {1, 1, 1}, 14.0 / edge, filled(voxels, colors));
    for (const Picture& picture : slices.pictures)
      CHECK(std::max(picture.width, picture.height) <= edge);
  }
}

TEST_CASE("label_slices: a pixel across borders is the mean of what it meets", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  labels->fill(CoordBBox(Coord(0), Coord(0, 3, 3)), 1);
  labels->fill(CoordBBox(Coord(1, 0, 0), Coord(3, 3, 3)), 2);
  const GrainColors colors = grainColors(*labels);
  SliceOptions options;
  options.edge = 2;  // two voxels a pixel
  const LabelSlices slices = labelSlices(*labels, CoordBBox(Coord(0), Coord(3)), colors, options);
  const Rgb a = colors.colorOf(1), b = colors.colorOf(2), seen = slices.pictures[0].at(0, 0);
  // Of three columns of places the middle one lies on the border, which is the second voxel's.
  for (size_t c = 0; c < 3; ++c) CHECK(std::abs(seen[c] - (a[c] + 2 * b[c]) / 3.0) <= 1);
  CHECK(slices.pictures[0].at(1, 0) == b);
}

TEST_CASE("label_slices: planes that are asked for, and those outside", "[label_slices]") {
  const LabelMap voxels = randomLabels(3, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  const GrainColors colors = grainColors(*labels);
  SliceOptions options;
  options.edge = 28;
  options.planes = {{0, -3}, {2, 4}, {2, -9}, {1, 5}};
  const LabelSlices slices = labelSlices(*labels, kBox, colors, options);
  REQUIRE(slices.planes.size() == 4);
  requirePlanes(slices, {1, 1, 1}, 0.5, filled(voxels, colors));
  for (const SlicePlane& outside : {SlicePlane{2, 5}, {2, -10}, {0, 10}}) {
    options.planes = {outside};
    CHECK_THROWS_WITH(labelSlices(*labels, kBox, colors, options),
                      vdb_madf::test::Contains("there is no slice"));
  }
}

TEST_CASE("label_slices: grains that are not shown are pale", "[label_slices]") {
  const LabelMap voxels = randomLabels(5, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  const GrainColors colors = grainColors(*labels);
  LabelMap some;
  for (const auto& [p, label] : voxels)
    if (label % 2) some.emplace(p, label);
  const Int32Grid::Ptr shown = labelGrid(some);
  SliceOptions options;
  options.edge = 14;
  options.shown = shown.get();
  requirePlanes(labelSlices(*labels, kBox, colors, options), {1, 1, 1}, 1, [&](const Coord& p) {
    return some.count(p) ? colors.colorOf(some.at(p)) : voxels.count(p) ? kPale : kEmpty;
  });
}

TEST_CASE("label_slices: gray values show between the outlines of grains", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  const CoordBBox box(Coord(0), Coord(19, 9, 9));
  labels->fill(CoordBBox(Coord(2, 0, 0), Coord(9, 9, 9)), 1);
  labels->fill(CoordBBox(Coord(10, 0, 0), Coord(17, 9, 9)), 2);
  const GrainColors colors = grainColors(*labels);
  SliceOptions options;
  options.edge = 600;
  options.planes = {{1, 4}};  // x-z: z is up
  GrayPlane gray{20, 10, {}};
  for (int z = 0; z < 10; ++z)
    for (int x = 0; x < 20; ++x) gray.values.push_back(uint8_t(10 * z + x));
  options.gray = {gray};
  const Picture picture = labelSlices(*labels, box, colors, options).pictures[0];
  const auto grayOf = [](int value) { return Rgb{uint8_t(value), uint8_t(value), uint8_t(value)}; };
  CHECK(picture.at(15, 285) == grayOf(0));    // voxel (0, 0)
  CHECK(picture.at(585, 285) == grayOf(19));  // (19, 0)
  CHECK(picture.at(15, 15) == grayOf(90));    // (0, 9)
  CHECK(picture.at(165, 135) == grayOf(55));  // (5, 5), within a grain
  // From both ends of a grain inwards its color, a dark and a light line, then gray.
  const Rgb dark = grayOf(25), light = grayOf(235);
  const std::vector<Rgb> left{colors.colorOf(1), colors.colorOf(1), dark, light, grayOf(52)};
  const std::vector<Rgb> right{colors.colorOf(2), colors.colorOf(2), dark, light, grayOf(67)};
  for (int i = 0; i < 5; ++i) {
    CHECK(picture.at(60 + i, 135) == left[size_t(i)]);
    CHECK(picture.at(539 - i, 135) == right[size_t(i)]);
  }
  CHECK(picture.at(59, 135) == grayOf(51));
  CHECK(picture.at(299, 135) == colors.colorOf(1));
  CHECK(picture.at(300, 135) == colors.colorOf(2));
  options.gray.front().width = 19;
  CHECK_THROWS_AS(labelSlices(*labels, box, colors, options), InvalidInput);
}

TEST_CASE("label_slices: unequal voxels are shown in true proportions", "[label_slices]") {
  const LabelMap voxels = randomLabels(4, kBox.min(), 14, 6, 50);
  const Int32Grid::Ptr labels = labelGrid(voxels);
  setVoxelSize(*labels, VoxelSize({2e-6, 1e-6, 2.5e-6}));  // 26 x 11 x 35 of the shortest edge
  const GrainColors colors = grainColors(*labels);
  for (const int edge : {35, 70, 80, 12}) {
    CAPTURE(edge);
    requirePlanes(slicesOf(*labels, edge), {2, 1, 2.5}, 35.0 / edge, filled(voxels, colors));
  }
}

TEST_CASE("label_slices: tiles are shown, inactive values are not", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  labels->tree().addTile(1, Coord(0), 5, true);
  labels->tree().addTile(1, Coord(8, 0, 0), 6, false);
  const GrainColors colors = grainColors(*labels);
  SliceOptions options;
  options.edge = 16;
  const LabelSlices slices =
      labelSlices(*labels, CoordBBox(Coord(0), Coord(15, 7, 7)), colors, options);
  CHECK(slices.pictures[0].at(7, 7) == colors.colorOf(5));
  CHECK(slices.pictures[0].at(8, 7) == kEmpty);
}

TEST_CASE("label_slices: an empty box or picture is refused", "[label_slices]") {
  const auto labels = Int32Grid::create(0);
  SliceOptions none;
  none.edge = 0;
  CHECK_THROWS_AS(labelSlices(*labels, CoordBBox(), {}), InvalidInput);
  CHECK_THROWS_AS(labelSlices(*labels, CoordBBox(Coord(0), Coord(3)), {}, none), InvalidInput);
}
