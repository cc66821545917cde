// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/gray_planes.h"

#include <algorithm>
#include <memory>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;

namespace {

/// Values x + 100 y + 10000 z; says how many slices were read.
class Ramp : public ImageReader {
 public:
  Ramp(int x, int y, int z) {
    info_.size = {x, y, z};
    info_.type = SampleType::float32;
    path_ = "ramp";
  }
  void read(int first, int count, void* samples) override {
    slicesRead += count;
    auto* to = static_cast<float*>(samples);
    for (int z = first; z < first + count; ++z)
      for (int y = 0; y < info_.size.y; ++y)
        for (int x = 0; x < info_.size.x; ++x) *to++ = value({x, y, z});
  }
  static float value(const Coord& p) { return float(p.x() + 100 * p.y() + 10000 * p.z()); }
  int slicesRead = 0;
};

}  // namespace

TEST_CASE("gray_planes: each voxel has its value, from black to white", "[gray_planes]") {
  const Coord shift(5, -2, 7);
  auto reader = std::make_unique<Ramp>(9, 11, 29);
  GrayScan scan{std::move(reader), shift};
  const CoordBBox box(shift + Coord(1, 2, 3), shift + Coord(7, 9, 26));
  const std::vector<SlicePlane> planes{{2, 20}, {1, 3}, {0, 9}, {2, 10}};
  const auto gray = readGrayPlanes(scan, box, planes);
  REQUIRE(gray.size() == planes.size());
  uint8_t darkest = 255, brightest = 0;
  std::vector<std::pair<float, uint8_t>> values;
  for (size_t i = 0; i < planes.size(); ++i) {
    REQUIRE(gray[i].width == box.dim()[planes[i].right()]);
    REQUIRE(gray[i].height == box.dim()[planes[i].down()]);
    for (int row = 0; row < gray[i].height; ++row)
      for (int column = 0; column < gray[i].width; ++column) {
        Coord p = box.min();
        p[planes[i].axis] = planes[i].index;
        p[planes[i].right()] += column;
        p[planes[i].down()] += row;
        const uint8_t value = gray[i].values[size_t(row * gray[i].width + column)];
        values.emplace_back(Ramp::value(p - shift), value);
        darkest = std::min(darkest, value);
        brightest = std::max(brightest, value);
      }
  }
  CHECK(darkest == 0);
  CHECK(brightest == 255);
  // One contrast for all: brightness grows with the value.
  std::sort(values.begin(), values.end());
  for (size_t i = 1; i < values.size(); ++i) REQUIRE(values[i].second >= values[i - 1].second);
}

TEST_CASE("gray_planes: slices that are not wanted are not read", "[gray_planes]") {
  auto reader = std::make_unique<Ramp>(4, 4, 100);
  const Ramp& ramp = *reader;
  GrayScan scan{std::move(reader), Coord(0)};
  readGrayPlanes(scan, CoordBBox(Coord(0), Coord(3, 3, 99)), {{2, 50}, {2, 51}});
  CHECK(ramp.slicesRead <= 8);
}

TEST_CASE("gray_planes: one value is gray, and the scan has to hold the box", "[gray_planes]") {
  GrayScan scan{std::make_unique<Ramp>(1, 1, 3), Coord(0)};
  const auto gray = readGrayPlanes(scan, CoordBBox(Coord(0), Coord(0, 0, 2)), {{2, 1}});
  CHECK(gray[0].values == std::vector<uint8_t>{128});
  CHECK_THROWS_WITH(readGrayPlanes(scan, CoordBBox(Coord(0), Coord(1, 0, 2)), {{2, 1}}),
                    vdb_madf::test::Contains("ramp: has 1x1x3 voxels"));
}
