// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/detail/grid_slabs.h"

#include <random>

#include "support/catch.h"

using namespace vdb_madf;

namespace {

/// 0 where the voxel is not active, as a label is read.
struct ActiveValue {
  int32_t operator()(int32_t value, bool active) const { return active ? value : 0; }
};

/// Voxels and tiles, active or not, around the origin.
Int32Grid::Ptr gridWithTiles(unsigned seed, int background) {
  std::mt19937 random(seed);
  const auto grid = Int32Grid::create(background);
  const auto place = [&] {
    return Coord(int(random() % 50) - 25, int(random() % 40) - 10, int(random() % 60) - 30);
  };
  for (int i = 0; i < 12; ++i)
    grid->tree().addTile(1, place(), int(random() % 100), random() % 2 != 0);
  for (int i = 0; i < 3000; ++i) {
    const Coord p = place();
    grid->tree().setValue(p, int(random() % 100));
    if (random() % 3 == 0) grid->tree().setActiveState(p, false);
  }
  grid->tree().addTile(2, Coord(128, 0, 0), 7, true);
  return grid;
}

/// Voxels that differ from what the grid says of them one by one; what lies beyond the slab counts.
template <typename ValueOf>
size_t slabDifferences(const Int32Grid& grid, const CoordBBox& box, int z, int count,
                       bool parallel) {
  constexpr int32_t kUntouched = -12345;
  const detail::GridSlabs<Int32Tree, ValueOf> slabs(grid.tree(), box);
  const CoordBBox slab = detail::slicesOf(box, z, count);
  std::vector<int32_t> values(slab.volume() + 1, kUntouched);
  if (parallel)
    slabs.readInParallel(z, count, values.data());
  else
    slabs.read(z, count, values.data());
  const auto voxels = grid.getConstAccessor();
  size_t i = 0, wrong = 0;
  for (int k = slab.min().z(); k <= slab.max().z(); ++k)
    for (int y = slab.min().y(); y <= slab.max().y(); ++y)
      for (int x = slab.min().x(); x <= slab.max().x(); ++x, ++i) {
        const Coord p(x, y, k);
        wrong += values[i] != ValueOf()(voxels.getValue(p), voxels.isValueOn(p));
      }
  return wrong + (values[i] != kUntouched);
}

}  // namespace

TEST_CASE("grid_slabs: slices from anywhere to anywhere equal the voxels", "[grid_slabs]") {
  for (const int background : {0, 5}) {
    const auto grid = gridWithTiles(3, background);
    for (const CoordBBox& box :
         {CoordBBox(Coord(-25, -10, -30), Coord(24, 29, 29)),
          CoordBBox(Coord(-3, 2, -13), Coord(11, 12, 6)), CoordBBox(Coord(0), Coord(0)),
          CoordBBox(Coord(120, -2, -1), Coord(140, 9, 17)), CoordBBox(Coord(-90), Coord(-80))})
      for (int z = box.min().z(); z <= box.max().z(); z += 7)
        for (const int count : {1, 2, 8, 9, 20}) {
          if (z + count - 1 > box.max().z()) continue;
          CAPTURE(background, box, z, count);
          REQUIRE(slabDifferences<detail::StoredValue>(*grid, box, z, count, false) == 0);
          REQUIRE(slabDifferences<detail::StoredValue>(*grid, box, z, count, true) == 0);
          REQUIRE(slabDifferences<ActiveValue>(*grid, box, z, count, false) == 0);
        }
  }
}
