// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/segment_array.h"

#include <cstdint>
#include <random>
#include <vector>

#include "support/catch.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/segment.h"

using namespace vdb_madf;

namespace {

/// Balls at random places in a box of unequal sides, some cut by its faces.
std::vector<uint8_t> ballsIn(const std::array<int64_t, 3>& size, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<uint8_t> mask(size_t(size[0] * size[1] * size[2]));
  for (int ball = 0; ball < 12; ++ball) {
    const int64_t radius = 4 + random() % 6;
    const std::array<int64_t, 3> center{int64_t(random() % unsigned(size[0])),
                                        int64_t(random() % unsigned(size[1])),
                                        int64_t(random() % unsigned(size[2]))};
    size_t i = 0;
    for (int64_t z = 0; z < size[2]; ++z)
      for (int64_t y = 0; y < size[1]; ++y)
        for (int64_t x = 0; x < size[0]; ++x, ++i) {
          const int64_t dx = x - center[0], dy = y - center[1], dz = z - center[2];
          if (dx * dx + dy * dy + dz * dz < radius * radius) mask[i] = uint8_t(1 + ball);
        }
  }
  return mask;
}

}  // namespace

TEST_CASE("segment_array: the labels are those of segment()", "[segment_array]") {
  const std::array<int64_t, 3> size{37, 26, 43};
  const std::vector<uint8_t> mask = ballsIn(size, GENERATE(1u, 2u, 3u));
  const auto grid = MaskGrid::create();
  size_t i = 0;
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x)
        if (mask[i++]) grid->tree().setValueOn(Coord(x, y, z));
  SegmentOptions options;
  options.domain = Domain(CoordBBox(Coord(0), Coord(36, 25, 42)));
  options.boundary = Boundary::open;

  const auto compare = [&](const ArrayOptions& few) {
    const ArraySegmentation result = segmentArray(mask.data(), size, few);
    const Segmentation expected = segment(*grid, options);
    REQUIRE(result.grainVoxels == expected.grainVoxels);
    REQUIRE(result.labels.size() == mask.size());
    size_t at = 0, differing = 0;
    for (int z = 0; z < size[2]; ++z)
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x)
          differing += result.labels[at++] != expected.grain->tree().getValue(Coord(x, y, z));
    REQUIRE(differing == 0);
  };
  compare({});
  options.gamma = 9;
  options.merge.strictness = 8;
  compare({9, 8});
  options.gamma = 0;
  options.merge = {};
  options.weights = VoxelWeights{1, 1, 4};
  compare({0, 11, VoxelSize({1e-6, 1e-6, 2e-6})});
}

TEST_CASE("segment_array: its defaults are those of segment()", "[segment_array]") {
  const ArrayOptions few;
  const SegmentOptions all;
  REQUIRE(few.gamma == all.gamma);
  REQUIRE(few.strictness == all.merge.strictness);
}

TEST_CASE("segment_array: odd input", "[segment_array]") {
  const std::vector<uint8_t> none(27), full(27, 1);
  REQUIRE(segmentArray(none.data(), {3, 3, 3}).labels == std::vector<int32_t>(27));
  REQUIRE(segmentArray(none.data(), {3, 3, 3}).grainVoxels.empty());
  std::vector<uint8_t> one(27);
  one[13] = 255;
  const ArraySegmentation found = segmentArray(one.data(), {3, 3, 3});
  REQUIRE(found.grainVoxels == std::vector<int64_t>{1});
  for (size_t i = 0; i < 27; ++i) REQUIRE(found.labels[i] == (i == 13 ? 1 : 0));
  REQUIRE_THROWS_WITH(segmentArray(full.data(), {3, 3, 3}), test::Contains("no background"));
  REQUIRE_THROWS_AS(segmentArray(full.data(), {3, 0, 3}), InvalidInput);
  REQUIRE_THROWS_AS(segmentArray(full.data(), {3, 3, -1}), InvalidInput);
  REQUIRE_THROWS_AS(segmentArray(full.data(), {int64_t(1) << 40, 3, 3}), InvalidInput);
  REQUIRE_THROWS_AS(segmentArray(full.data(), {3, 3, 3}, {0, 1e6}), InvalidInput);
}
