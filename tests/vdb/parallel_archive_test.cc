// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <tbb/global_control.h>

#include <limits>
#include <random>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

// What we write is, byte for byte, what openvdb::io::File writes, but for the UUID.

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::GridBase;

namespace {

std::string withoutUuid(std::string bytes) {
  return bytes.replace(21, 36, 36, '-');
}

/// Where the two files differ; npos: nowhere.
size_t firstDifference(const Grids& grids) {
  initialize();
  const TemporaryFolder folder;
  writeVdb(folder.file("ours.vdb"), grids);
  writeWithOpenVdb(folder.file("theirs.vdb"), grids);
  const std::string ours = withoutUuid(bytesOf(folder.file("ours.vdb")));
  const std::string theirs = withoutUuid(bytesOf(folder.file("theirs.vdb")));
  if (ours == theirs) return std::string::npos;
  size_t i = 0;
  while (i < std::min(ours.size(), theirs.size()) && ours[i] == theirs[i]) ++i;
  return i;
}

/// Leaf nodes with few or many different values, active or not, and tiles of all levels. Inactive
/// values are the background, its negative, one or two or many others.
template <typename Grid>
typename Grid::Ptr randomGrid(unsigned seed, int leaves) {
  using Value = typename Grid::ValueType;
  std::mt19937 random(seed);
  const auto below = [&](uint32_t n) { return random() % n; };
  const auto grid = Grid::create(Value(int(below(2)) * 7));
  const Value background = grid->background();
  for (int i = 0; i < leaves; ++i) {
    const Coord origin(8 * int(below(80)) - 300, 8 * int(below(40)), 8 * int(below(40)) - 5000);
    auto& leaf = *grid->tree().touchLeaf(origin);
    const uint32_t kind = below(7), values = 1 + below(3) * below(1000), active = below(5);
    for (openvdb::Index v = 0; v < leaf.SIZE; ++v) {
      const auto some = Value(int(below(values)) - 3);
      if (below(4) < active) {
        leaf.setValueOn(v, some);
      } else {
        const uint32_t which = below(kind < 3 ? 1 : 2);
        if (kind == 6)
          leaf.setValueOff(v, some);
        else if (kind % 3 == 0)
          leaf.setValueOff(v, which == 0 ? background : Value(5));
        else if (kind % 3 == 1)
          leaf.setValueOff(v, which == 0 ? Value(-background) : background);
        else
          leaf.setValueOff(v, which == 0 ? Value(11) : Value(-12));
      }
    }
  }
  for (openvdb::Index level = 1; level <= 3; ++level)
    if (below(2))
      grid->tree().addTile(level, Coord(int(below(20000)), 0, 9000), Value(3), below(2) == 0);
  grid->setName("grid" + std::to_string(seed));
  return grid;
}

}  // namespace

TEMPLATE_TEST_CASE("parallel_archive: random grids are written as OpenVDB writes them",
                   "[parallel_archive]", Int32Grid, FloatGrid, DoubleGrid, Int64Grid) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    INFO("seed " << seed);
    const auto grid = randomGrid<TestType>(seed, seed % 4 == 0 ? int(seed / 4) : 20);
    if (seed % 3 == 1) grid->setGridClass(openvdb::GRID_LEVEL_SET);
    if (seed % 3 == 2) grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    grid->setSaveFloatAsHalf(seed % 5 == 0);
    REQUIRE(firstDifference({grid}) == std::string::npos);
  }
}

TEMPLATE_TEST_CASE("parallel_archive: balls with tiles are written as OpenVDB writes them",
                   "[parallel_archive]", BoolGrid, MaskGrid, Int32Grid, FloatGrid, Vec3sGrid) {
  const auto empty = TestType::create();
  empty->setName("empty");
  const auto onlyTiles = TestType::create();
  onlyTiles->tree().addTile(2, Coord(0), valueAt<typename TestType::ValueType>(Coord(1)), true);
  REQUIRE(firstDifference({empty}) == std::string::npos);
  REQUIRE(firstDifference({onlyTiles}) == std::string::npos);
  REQUIRE(firstDifference(
              {empty, onlyTiles, ballWithTiles<TestType>(Coord(-90, 4, 9), 20, "ball", true)}) ==
          std::string::npos);
}

TEST_CASE("parallel_archive: many leaf nodes are written alike on any number of threads",
          "[parallel_archive]") {
  const auto labels = randomGrid<Int32Grid>(1, 3000);
  for (const size_t threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    REQUIRE(firstDifference({labels}) == std::string::npos);
  }
}

TEST_CASE("parallel_archive: values that equal nothing or each other are written alike",
          "[parallel_archive]") {
  for (const float background : {0.0f, -0.0f, std::numeric_limits<float>::quiet_NaN()}) {
    const auto grid = FloatGrid::create(background);
    grid->tree().setValue(Coord(0), 1.0f);
    grid->tree().setValueOff(Coord(0, 0, 1), 0.0f);
    grid->tree().setValueOff(Coord(0, 0, 2), -0.0f);
    grid->tree().setValueOff(Coord(0, 8, 2), std::numeric_limits<float>::quiet_NaN());
    REQUIRE(firstDifference({grid}) == std::string::npos);
  }
  const auto extreme = Int32Grid::create(std::numeric_limits<int32_t>::min());
  extreme->tree().setValue(Coord(0), std::numeric_limits<int32_t>::max());
  REQUIRE(firstDifference({extreme}) == std::string::npos);
}

TEST_CASE("parallel_archive: several grids are written as OpenVDB writes them",
          "[parallel_archive]") {
  const auto labels = randomGrid<Int32Grid>(3, 30), sameName = randomGrid<Int32Grid>(4, 30);
  sameName->setName(labels->getName());
  const auto nameless = randomGrid<FloatGrid>(5, 5);
  const auto alsoNameless = randomGrid<BoolGrid>(6, 5);
  nameless->setName("");
  alsoNameless->setName("");
  const auto shared = labels->copyWithNewTree();
  shared->setTree(labels->treePtr());
  shared->setName("shared");
  const auto asHalf = nameless->deepCopy(), wholeAgain = nameless->deepCopy();
  asHalf->setTree(nameless->treePtr());
  asHalf->setSaveFloatAsHalf(true);
  wholeAgain->setTree(nameless->treePtr());
  wholeAgain->setName("again");
  labels->insertMeta("text", openvdb::StringMetadata("several\nlines"));
  setGraph(*sameName, smallGraph());
  sameName->setTransform(openvdb::math::Transform::createLinearTransform(0.3));
  const auto points = GridBase::createGrid("Tree_ptdataidx32_5_4_3");
  points->setName("points");
  CHECK(firstDifference({labels, sameName, shared, nameless, alsoNameless, asHalf, wholeAgain,
                         levelSet(), points}) == std::string::npos);
  CHECK(firstDifference({}) == std::string::npos);
}
