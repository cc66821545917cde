// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment_memory.h"

#include "support/catch.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

TEST_CASE("segment_memory: tiles count as the leaves they stand for", "[segment_memory]") {
  const ObjectVolume object(boxAt({-8, 0, 8}, {24, 40, 16}), 1);
  for (const Tiles tiles : {Tiles::none, Tiles::wherePossible}) {
    const ObjectSize size = objectSize(*toMask(object, tiles));
    CHECK(size.leaves == 3 * 5 * 2);
    CHECK(size.voxels == 24 * 40 * 16);
  }
  CHECK(objectSize(*MaskGrid::create()).leaves == 0);
}

TEST_CASE("segment_memory: voxels of thin structures are counted apart", "[segment_memory]") {
  const auto thin = [](const CoordBBox& box) {
    return objectSize(*toMask(ObjectVolume(box, 1))).thin;
  };
  CHECK(thin(boxAt({-9, 3, 5}, {40, 40, 40})) < 40 * 40 * 40 / 100);
  // Of sheets and wires of all places, on average, about all.
  int64_t sheets = 0, wires = 0;
  for (int x = 0; x < 8; ++x) {
    sheets += thin(boxAt({x, 0, 0}, {2, 64, 64}));
    for (int y = 0; y < 8; ++y) wires += thin(boxAt({x, y, 0}, {1, 1, 64}));
  }
  CHECK(double(sheets) == Approx(8 * 2 * 64 * 64).epsilon(0.2));
  CHECK(double(wires) == Approx(64 * 64).epsilon(0.02));
  const ObjectSize thick{1000, 100000, 0}, wire{1000, 100000, 100000};
  CHECK(segmentMemory(wire) > segmentMemory(thick) + 9000000);
}

TEST_CASE("segment_memory: specks are pieces, and grains of tables", "[segment_memory]") {
  ObjectVolume specks(boxAt({0, 0, 0}, {64, 64, 64}), 0);
  for (int x = 0; x < 64; x += 2)
    for (int y = 0; y < 64; y += 2)
      for (int z = 0; z < 64; z += 2) specks[Coord(x, y, z)] = 1;
  const ObjectSize size = objectSize(*toMask(specks));
  CHECK(size.pieces == 32 * 32 * 32);
  CHECK(double(size.specks) == Approx(32 * 32 * 32).epsilon(0.01));
  CHECK(tablesMemory(size) > segmentMemory(size));
  const ObjectSize thick = objectSize(*toMask(ObjectVolume(boxAt({0, 0, 0}, {64, 64, 64}), 1)));
  CHECK(thick.pieces == 0);
  CHECK(tablesMemory(thick) < segmentMemory(thick));
}

TEST_CASE("segment_memory: the angle's crumbs are grains of tables", "[segment_memory]") {
  SegmentOptions angle;
  angle.merge.mode = MergeMode::angle;
  const ObjectSize size{64000, 10000000, 400000};
  CHECK(tablesMemory(size, angle) > tablesMemory(size) + 2000 * size.thin);
  angle.gamma = 9;
  CHECK(tablesMemory(size, angle) < tablesMemory(size) + 1500 * size.thin);
}

TEST_CASE("segment_memory: holds what is known exactly, and nothing of the bounding box",
          "[segment_memory]") {
  const ObjectSize size{1000000, 300000000};
  const int64_t plain = segmentMemory(size);
  CHECK(plain > 8 * size.voxels);   // power and site
  CHECK(plain < 12 * size.voxels);  // and little more
  SegmentOptions keeping;
  keeping.keepManifold = true;
  CHECK(segmentMemory(size, keeping) > 2 * 2048 * size.leaves);  // two label grids
  SegmentOptions filtering;
  filtering.gamma = 20;
  CHECK(segmentMemory(size, filtering) > plain);
  // Twice the object, twice the memory (but for what every run needs).
  const int64_t none = segmentMemory({0, 0});
  CHECK(segmentMemory({2 * size.leaves, 2 * size.voxels}) - none == Approx(2 * (plain - none)));
}

TEST_CASE("segment_memory: what does not fit is refused before work starts", "[segment_memory]") {
  const MaskGrid::Ptr mask = toMask(ObjectVolume(boxAt({0, 0, 0}, {16, 16, 16}), 1));
  SegmentOptions options;
  const int64_t needed = segmentMemory(objectSize(*mask), options);
  options.maxMemory = needed;
  CHECK(segment(*mask, options).counts.grains == 1);
  options.maxMemory = needed - 1;
  CHECK_THROWS_WITH(segment(*mask, options),
                    vdb_madf::test::Contains(readableBytes(needed) + " of memory"));
  CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
}
