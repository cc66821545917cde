// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/interface_voxels.h"

#include "support/catch.h"
#include "support/label_shapes.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// By the definition, voxel by voxel.
LabelMap naiveInterfaces(const LabelMap& voxels) {
  LabelMap result;
  for (const auto& [p, label] : voxels)
    for (const Coord& step : {Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)})
      for (const Coord& q : {p + step, p - step}) {
        const auto other = voxels.find(q);
        if (other != voxels.end() && other->second != label) result[p] = label;
      }
  return result;
}

LabelMap voxelsOf(const Int32Grid& grid) {
  LabelMap result;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) result[voxel.getCoord()] = *voxel;
  return result;
}

}  // namespace

TEST_CASE("interface_voxels: those that share a face with another grain", "[interface_voxels]") {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    const LabelMap voxels = randomLabels(seed, Coord(-7, 3, -20), 20, 6, 60);
    const LabelMap expected = naiveInterfaces(voxels);
    REQUIRE(expected.size() > 50);
    REQUIRE(expected.size() < voxels.size());
    CHECK(voxelsOf(*interfaceVoxels(*labelGrid(voxels))) == expected);
  }
}

TEST_CASE("interface_voxels: tiles have them, too, and provenance is kept", "[interface_voxels]") {
  const auto labels = Int32Grid::create(0);
  labels->setName("grain");
  setVoxelSize(*labels, VoxelSize{2e-6});
  labels->fill(CoordBBox(Coord(0), Coord(7)), 1);
  labels->fill(CoordBBox(Coord(8, 0, 0), Coord(15, 7, 7)), 2);
  REQUIRE(labels->tree().activeTileCount() == 2);
  const Int32Grid::Ptr found = interfaceVoxels(*labels);
  CHECK(found->activeVoxelCount() == 2 * 64);
  CHECK(found->tree().getValue(Coord(7, 3, 3)) == 1);
  CHECK(found->tree().getValue(Coord(8, 3, 3)) == 2);
  CHECK(found->getName() == "grain");
  CHECK(storedVoxelSize(*found).has_value());
  CHECK(interfaceVoxels(*Int32Grid::create(0))->empty());
}
