// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/object_mask.h"

#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/other_grids.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"

using namespace vdb_madf;

namespace {

template <typename Value>
using GridOf = openvdb::Grid<StandardTree<Value>>;

const CoordBBox kRegion(Coord(-20, -9, -3), Coord(25, 30, 40));

template <typename Value>
auto someValue(std::mt19937& random) {
  using Stored = typename GridOf<Value>::ValueType;
  const int number = int(random() % 5) - 2;
  if constexpr (std::is_floating_point_v<Stored>)
    return random() % 7 == 0 ? std::numeric_limits<Stored>::quiet_NaN() : Stored(number) / 2;
  else
    return Stored(number);
}

/// Active and inactive voxels and tiles of all kinds of values.
template <typename Value>
typename GridOf<Value>::Ptr randomGrid(unsigned seed) {
  std::mt19937 random(seed);
  const auto grid = GridOf<Value>::create(typename GridOf<Value>::ValueType(0));
  const auto coordinate = [&](int axis) {
    return kRegion.min()[axis] + int(random() % unsigned(kRegion.dim()[axis]));
  };
  for (int i = 0; i < 12; ++i)  // tiles of eight voxels a side
    grid->tree().addTile(1, Coord(coordinate(0), coordinate(1), coordinate(2)),
                         someValue<Value>(random), random() % 2 != 0);
  grid->tree().addTile(2, Coord(200, 0, 0), someValue<Value>(random), random() % 2 != 0);
  for (int i = 0; i < 3000; ++i) {
    const Coord p(coordinate(0), coordinate(1), coordinate(2));
    if (random() % 4)
      grid->tree().setValue(p, someValue<Value>(random));
    else
      grid->tree().setValueOff(p, someValue<Value>(random));
  }
  return grid;
}

/// The documented meaning, asked of one voxel.
template <typename Value>
bool expected(const GridOf<Value>& grid, typename GridOf<Value>::ConstAccessor& voxels,
              const Coord& p, const std::optional<Selection>& selection) {
  typename GridOf<Value>::ValueType value;
  const bool active = voxels.probeValue(p, value);
  if (!selection && grid.getGridClass() == openvdb::GRID_LEVEL_SET) return double(value) < 0;
  if (!selection) return active && double(value) > 0;
  Selection plain = *selection;
  plain.invert = false;
  if (!selection->invert) return active && plain(double(value));
  const auto extent = storedDomain(grid);
  return extent->isInside(p) && value == value && !(active && plain(double(value)));
}

template <typename Value>
void compare(const GridOf<Value>& grid, const std::optional<Selection>& selection) {
  const auto mask = objectMask(grid, selection);
  CoordBBox box = kRegion;
  box.expand(10);
  uint64_t inside = 0;
  auto voxels = grid.getConstAccessor();
  const auto objects = mask->getConstAccessor();
  for (auto p = box.begin(); p != box.end(); ++p) {
    const bool object = objects.isValueOn(*p);
    inside += object;
    if (object == expected<Value>(grid, voxels, *p, selection) && objects.getValue(*p) == object)
      continue;
    CAPTURE(*p, object, grid.valueType());
    FAIL("differs from the documented meaning");
  }
  const bool tile = expected<Value>(grid, voxels, Coord(250, 1, 1), selection);
  CHECK(mask->activeVoxelCount() == inside + (tile ? 128u * 128u * 128u : 0u));
}

template <typename Value>
void compareAll(unsigned seed) {
  const auto grid = randomGrid<Value>(seed);
  std::vector<std::optional<Selection>> selections = {std::nullopt,
                                                      Selection{},
                                                      Selection::phase(1),
                                                      Selection::phase(0),
                                                      Selection::threshold(0.5),
                                                      Selection::range(-1, 0)};
  for (const auto& selection : selections) compare<Value>(*grid, selection);
  setDomain(*grid, CoordBBox(Coord(-15, -3, 0), Coord(27, 20, 41)));
  for (auto selection : selections) {
    if (!selection) continue;
    selection->invert = true;
    compare<Value>(*grid, selection);
  }
  if (std::is_same_v<Value, bool> || std::is_same_v<Value, openvdb::ValueMask>) return;
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  compare<Value>(*grid, std::nullopt);
}

}  // namespace

TEST_CASE("object_mask: equals the documented meaning voxel by voxel", "[object_mask]") {
  compareAll<bool>(1);
  compareAll<openvdb::ValueMask>(2);
  compareAll<int32_t>(3);
  compareAll<int64_t>(4);
  compareAll<float>(5);
  compareAll<double>(6);
}

TEST_CASE("object_mask: a level set is filled", "[object_mask]") {
  const auto ball = openvdb::tools::createLevelSetSphere<FloatGrid>(30, openvdb::Vec3f(3, 4, 5), 1);
  const auto mask = objectMask(*ball);
  const double volume = 4.0 / 3.0 * M_PI * 30 * 30 * 30;
  CHECK(double(mask->activeVoxelCount()) == Approx(volume).epsilon(0.01));
  CHECK(mask->tree().isValueOn(Coord(3, 4, 5)));
  CHECK_FALSE(mask->tree().isValueOn(Coord(34, 4, 5)));

  const auto inverted = FloatGrid::create(-3.0F);
  inverted->setGridClass(openvdb::GRID_LEVEL_SET);
  CHECK_THROWS_AS(objectMask(*inverted), InvalidInput);
}

TEST_CASE("object_mask: tiles stay tiles", "[object_mask]") {
  const auto grid = Int32Grid::create(0);
  grid->tree().addTile(3, Coord(0), 5, true);
  grid->tree().addTile(2, Coord(4096, 0, 0), 5, true);
  grid->tree().addTile(1, Coord(-8, 0, 0), 5, true);
  const auto mask = objectMask(*grid);
  CHECK(mask->tree().activeTileCount() == 3);
  CHECK(mask->tree().leafCount() == 0);
  CHECK(mask->activeVoxelCount() == (uint64_t(1) << 36) + (1u << 21) + 512u);

  setDomain(*grid, CoordBBox(Coord(0), Coord(4095, 4095, 8191)));
  Selection selection = Selection::phase(5);
  selection.invert = true;
  const auto rest = objectMask(*grid, selection);
  CHECK(rest->activeVoxelCount() == uint64_t(1) << 36);
  CHECK(rest->tree().leafCount() == 0);
}

TEST_CASE("object_mask: a background that is NaN is no object", "[object_mask]") {
  const auto grid = FloatGrid::create(std::numeric_limits<float>::quiet_NaN());
  grid->tree().setValue(Coord(1, 2, 3), 1.0F);
  grid->tree().setValue(Coord(2, 2, 3), 2.0F);
  setDomain(*grid, CoordBBox(Coord(0), Coord(9)));
  Selection selection = Selection::phase(2);
  selection.invert = true;
  const auto mask = objectMask(*grid, selection);
  CHECK(mask->activeVoxelCount() == 1);
  CHECK(mask->tree().isValueOn(Coord(1, 2, 3)));
}

TEST_CASE("object_mask: what cannot be is refused", "[object_mask]") {
  const auto vectors = test::Vec3sGrid::create();
  CHECK_THROWS_AS(objectMask(*vectors), InvalidInput);
  const auto grid = Int32Grid::create(0);
  Selection selection;
  selection.invert = true;
  CHECK_THROWS_AS(objectMask(*grid, selection), InvalidInput);
}

TEST_CASE("object_mask: an empty grid gives an empty mask with its provenance", "[object_mask]") {
  const auto grid = FloatGrid::create(0);
  setDomain(*grid, CoordBBox(Coord(-1), Coord(7)));
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  grid->insertMeta("madf_source", openvdb::StringMetadata("scan.tif"));
  const auto mask = objectMask(*grid);
  CHECK(mask->empty());
  CHECK(storedDomain(*mask) == CoordBBox(Coord(-1), Coord(7)));
  CHECK(storedVoxelSize(*mask)->edge() == 8.5e-6);
  CHECK(mask->metaValue<std::string>("madf_source") == "scan.tif");
  CHECK(mask->transform() == grid->transform());
}
