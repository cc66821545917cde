// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/gray_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

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

namespace {

/// What readGrayBlocks() says of a scan, each block by itself.
std::vector<uint8_t> blocksOneByOne(const CoordBBox& scan, const CoordBBox& blocks, int factor) {
  std::vector<float> means;
  for (int z = blocks.min().z(); z <= blocks.max().z(); ++z)
    for (int y = blocks.min().y(); y <= blocks.max().y(); ++y)
      for (int x = blocks.min().x(); x <= blocks.max().x(); ++x) {
        double sum = 0;
        int count = 0;
        const Coord low(x * factor, y * factor, z * factor);
        CoordBBox block(low, low.offsetBy(factor - 1));
        block.intersect(scan);
        for (auto p = block.begin(); p; ++p, ++count) sum += Ramp::value(*p - scan.min());
        means.push_back(float(sum / count));
      }
  std::vector<float> sorted = means;
  std::sort(sorted.begin(), sorted.end());
  const size_t clipped = sorted.size() / 200;
  const double low = sorted[clipped], high = sorted[sorted.size() - 1 - clipped];
  std::vector<uint8_t> gray;
  for (const float mean : means)
    gray.push_back(
        uint8_t(std::lround(255 * std::clamp((double(mean) - low) / (high - low), 0.0, 1.0))));
  return gray;
}

/// A scan of nothing but values that are not finite, but for one voxel.
class Holes : public ImageReader {
 public:
  Holes() {
    info_.size = {4, 4, 4};
    info_.type = SampleType::float32;
  }
  void read(int first, int count, void* samples) override {
    auto* to = static_cast<float*>(samples);
    std::fill_n(to, 16 * count, std::numeric_limits<float>::quiet_NaN());
    if (first == 0) to[0] = 5;
  }
};

}  // namespace

TEST_CASE("gray_planes: blocks show the mean of the voxels that the scan has", "[gray_planes]") {
  const Coord first(-5, 2, -7);
  GrayScan scan{std::make_unique<Ramp>(19, 11, 29), first};
  for (const int factor : {1, 3, 4}) {
    const auto down = [&](int value) { return int(std::floor(double(value) / factor)); };
    const CoordBBox whole = scan.box();
    CoordBBox blocks;
    for (const Coord& end : {whole.min(), whole.max()})
      blocks.expand(Coord(down(end.x()), down(end.y()), down(end.z())));
    CHECK(readGrayBlocks(scan, blocks, factor) == blocksOneByOne(whole, blocks, factor));
    blocks.min() = blocks.min().offsetBy(0, 1, 1);
    blocks.max() = blocks.max().offsetBy(-1, 0, -1);
    CHECK(readGrayBlocks(scan, blocks, factor) == blocksOneByOne(whole, blocks, factor));
  }
}

TEST_CASE("gray_planes: blocks without a value are black", "[gray_planes]") {
  GrayScan scan{std::make_unique<Holes>(), Coord(0)};
  CHECK(readGrayBlocks(scan, CoordBBox(Coord(0), Coord(1)), 2) ==
        std::vector<uint8_t>{128, 0, 0, 0, 0, 0, 0, 0});
}
