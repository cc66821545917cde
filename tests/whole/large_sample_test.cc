// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// A sample of 300^3 voxels, too large for the oracle: what must not change the labels does not.

#include <tbb/global_control.h>

#include "support/catch.h"
#include "vdb_madf/samples/pack.h"
#include "vdb_madf/segmentation/segment.h"

namespace {

using namespace vdb_madf;

MaskGrid::Ptr largeSample() {
  PackOptions options;
  options.size = Coord(300);
  options.fraction = 0.35;
  options.minRadius = 10;
  options.maxRadius = 35;
  return generatePack(options).object;
}

Segmentation segmentWith(const MaskGrid& object, int64_t gamma, size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  SegmentOptions options;
  options.gamma = gamma;
  options.keepManifold = true;
  return segment(object, options);
}

/// Voxels at which two grids differ, in value or in being active.
int64_t differences(const Int32Grid& a, const Int32Grid& b) {
  int64_t count = 0;
  const auto compareTo = [&](const Int32Grid& from, const Int32Grid& to) {
    const auto other = to.getConstAccessor();
    for (auto voxel = from.cbeginValueOn(); voxel; ++voxel) {
      int32_t value = 0;
      count += !other.probeValue(voxel.getCoord(), value) || value != *voxel;
    }
  };
  compareTo(a, b);
  compareTo(b, a);
  return count;
}

}  // namespace

TEST_CASE("large_sample: threads and tiles change no voxel", "[large_sample]") {
  const MaskGrid::Ptr object = largeSample();
  REQUIRE(object->tree().activeTileCount() > 100);
  const MaskGrid::Ptr voxelised = object->deepCopy();
  voxelised->tree().voxelizeActiveTiles();
  REQUIRE(voxelised->tree().activeTileCount() == 0);

  const int64_t gamma = GENERATE(0, 20);
  const Segmentation reference = segmentWith(*object, gamma, 1);
  CHECK(reference.counts.grains > 50);
  for (const Segmentation& other :
       {segmentWith(*object, gamma, 2), segmentWith(*voxelised, gamma, 2)}) {
    CHECK(differences(*reference.grain, *other.grain) == 0);
    CHECK(differences(*reference.manifold, *other.manifold) == 0);
    CHECK(reference.graph.nodes == other.graph.nodes);
    CHECK(reference.graph.edges == other.graph.edges);
  }
}
