// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/segment_memory.h"

#include "support/catch.h"
#include "support/random_volume.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/memory.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Single voxels, every second one along each axis.
MaskGrid::Ptr specks(int side, int from = 0) {
  const MaskGrid::Ptr mask = MaskGrid::create();
  for (int x = 0; x < side; x += 2)
    for (int y = 0; y < side; y += 2)
      for (int z = 0; z < side; z += 2) mask->tree().setValueOn(Coord(from + x, y, z));
  return mask;
}

}  // namespace

TEST_CASE("segment_memory: tiles count as the leaves they stand for", "[segment_memory]") {
  const ObjectVolume object(boxAt({-8, 0, 8}, {24, 40, 16}), 1);
  for (const Tiles tiles : {Tiles::none, Tiles::wherePossible}) {
    const ObjectSize size = sampledSize(*toMask(object, tiles));
    CHECK(size.leaves == 3 * 5 * 2);
    CHECK(size.voxels == 24 * 40 * 16);
  }
  CHECK(sampledSize(*MaskGrid::create()).leaves == 0);
}

TEST_CASE("segment_memory: a small object is counted, as it is segmented", "[segment_memory]") {
  Rng rng(5);
  const ObjectVolume object =
      randomVolume(VolumeKind::pinholes, boxAt({3, 0, -9}, {40, 40, 40}), rng);
  SegmentOptions options;
  options.gamma = 3;
  const MaskGrid::Ptr mask = toMask(object);
  const ObjectSize size = sampledSize(*mask, options);
  const Segmentation s = segment(*mask, options);
  CHECK(size.cavities == s.counts.cavities);
  CHECK(size.balls == s.counts.medialBalls);
  CHECK(size.keptBalls == s.counts.keptBalls);
  CHECK(size.points == s.counts.criticalPoints);
  CHECK(size.edges == int64_t(s.graph.edges.size()));
  CHECK(size.grains == s.counts.grains);
  CHECK(size.parts >= size.grains);
  CHECK(size.ballLeaves == 0);
  options.keepBalls = true;
  CHECK(sampledSize(*mask, options).ballLeaves > 0);
}

TEST_CASE("segment_memory: a sample tells of a large object, whose faces are closed or open",
          "[segment_memory]") {
  const MaskGrid::Ptr mask = specks(160);
  const ObjectSize size = sampledSize(*mask);
  const int64_t count = 80 * 80 * 80;
  for (const int64_t found : {size.voxels, size.balls, size.points, size.grains, size.parts})
    CHECK(found == count);
  CHECK(size.bonds == 0);
  // A plate that fills its domain has depth where its faces are closed, and none where they go on.
  const MaskGrid::Ptr plate = MaskGrid::create();
  const CoordBBox box(Coord(0), Coord(399, 399, 19));
  plate->denseFill(box, true);
  setDomain(*plate, box);
  SegmentOptions options;
  options.boundary = Boundary::open;
  CHECK(sampledSize(*plate, options).balls == 0);
  options.boundary = Boundary::closed;
  CHECK(sampledSize(*plate, options).balls > 100000);
}

TEST_CASE("segment_memory: no object of as many voxels is larger than the largest",
          "[segment_memory]") {
  const MaskGrid::Ptr mask = specks(32);
  const ObjectSize size = sampledSize(*mask), most = sizeAtMost(*mask);
  CHECK(most.leaves == size.leaves);
  CHECK(most.points == size.points);
  CHECK(segmentMemory(most) >= segmentMemory(size));
  CHECK(tablesMemory(most) >= tablesMemory(size));
  CHECK(tablesMemory(size) > segmentMemory(size));  // of as many grains as voxels
  const ObjectSize thick = sampledSize(*toMask(ObjectVolume(boxAt({0, 0, 0}, {64, 64, 64}), 1)));
  CHECK(tablesMemory(thick) < segmentMemory(thick));
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
  CHECK(double(segmentMemory({2 * size.leaves, 2 * size.voxels}) - none) ==
        Approx(2 * double(plain - none)));
}

TEST_CASE("segment_memory: what does not fit is refused before work starts", "[segment_memory]") {
  const MaskGrid::Ptr mask = toMask(ObjectVolume(boxAt({0, 0, 0}, {16, 16, 16}), 1));
  SegmentOptions options;
  const int64_t needed = segmentMemory(sampledSize(*mask), options);
  options.maxMemory = needed;
  CHECK(segment(*mask, options).counts.grains == 1);
  options.maxMemory = needed - 1;
  CHECK_THROWS_WITH(segment(*mask, options),
                    vdb_madf::test::Contains(readableBytes(needed) + " of memory"));
  CHECK_THROWS_AS(segment(*mask, options), InvalidInput);
}

TEST_CASE("segment_memory: what a sample missed is refused once it is known", "[segment_memory]") {
  // Cubes, where all of the sample lies, and specks far away.
  const MaskGrid::Ptr mask = specks(32, 8192);
  for (int i = 0; i < 8; ++i)
    mask->denseFill(CoordBBox::createCube(Coord(0, 0, 128 * i), 64), true);
  SegmentOptions options;
  options.maxMemory = segmentMemory(sampledSize(*mask), options) + 100000;
  CHECK_THROWS_WITH(segment(*mask, options), vdb_madf::test::Contains("of memory"));
  options.maxMemory *= 2;
  CHECK(segment(*mask, options).counts.grains == 8 + 16 * 16 * 16);
}
