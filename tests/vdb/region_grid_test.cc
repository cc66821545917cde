// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <openvdb/io/File.h>

#include <memory>
#include <string>

#include "support/catch.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/write_vdb.h"

// Domains that are regions, in files.

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::GridBase;

namespace {

/// A ball of more than a leaf, and a tile beside it.
Domain ball(int radius = 9) {
  MaskTree tree;
  for (int x = -radius; x <= radius; ++x)
    for (int y = -radius; y <= radius; ++y)
      for (int z = -radius; z <= radius; ++z)
        if (x * x + y * y + z * z <= radius * radius) tree.setValueOn(Coord(x, y, z));
  tree.addTile(2, Coord(128, 0, 0), true, true);
  return Domain(tree);
}

Int32Grid::Ptr gridIn(const Domain& domain, const std::string& name) {
  const auto grid = Int32Grid::create();
  grid->tree().setValue(Coord(1, 2, 3), 4);
  grid->setName(name);
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  setDomain(*grid, domain);
  return grid;
}

VdbReadOptions onlyNamed(const std::string& name) {
  VdbReadOptions options;
  options.wanted = [name](const GridBase& grid) { return grid.getName() == name; };
  return options;
}

std::vector<std::string> namesOf(const std::vector<GridBase::Ptr>& grids) {
  std::vector<std::string> names;
  for (const auto& grid : grids) names.push_back(grid->getName());
  return names;
}

/// The Bool grid that a file has for a region.
BoolGrid::Ptr boolGrid(const Domain& domain) {
  const auto grid = BoolGrid::create(
      std::make_shared<BoolGrid::TreeType>(*domain.region(), false, true, openvdb::TopologyCopy()));
  grid->setName("region");
  return grid;
}

/// As a file has it: the name alone. Another program may say more or less of the box.
Int32Grid::Ptr gridNaming(const std::string& region) {
  const auto grid = gridIn(CoordBBox(Coord(-9), Coord(255, 127, 127)), "grain");
  grid->insertMeta("madf_region", openvdb::StringMetadata(region));
  return grid;
}

}  // namespace

TEST_CASE("region_grid: a domain that is a region comes back", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb"), again = folder.file("b.vdb");
  const auto box = gridIn(CoordBBox(Coord(0), Coord(9)), "box");
  writeVdb(path, {gridIn(ball(), "grain"), gridIn(ball(), "manifold"), box});
  const auto grids = readVdb(path);
  CHECK(namesOf(grids) == std::vector<std::string>{"grain", "manifold", "box", "region"});
  for (size_t i : {size_t(0), size_t(1)}) {
    REQUIRE(storedDomain(*grids[i]));
    CHECK(*storedDomain(*grids[i]) == ball());
  }
  CHECK(storedDomain(*grids[0])->region() == storedDomain(*grids[1])->region());
  CHECK(*storedDomain(*grids[2]) == *storedDomain(*box));
  CHECK(*storedDomain(*grids[3]) == Domain(ball().box()));
  CHECK(grids[3]->transform() == grids[0]->transform());
  CHECK(grids[3]->activeVoxelCount() == uint64_t(ball().voxelCount()));
  CHECK(storedDomain(*grids[0]->deepCopyGrid()) == ball());

  // What was read is what is written, with the region in its place.
  writeVdb(again, {grids.begin(), grids.end()});
  CHECK(bytesOf(again) == bytesOf(path));
  // Without its region a grid is written as any other.
  setDomain(*grids[0], ball().box());
  writeVdb(again, {grids[0]});
  CHECK(readVdb(again).size() == 1);
}

TEST_CASE("region_grid: the region is read with the grids that are wanted", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  // The region may come first.
  writeVdb(path, {boolGrid(ball()), gridIn(ball(), "grain")});
  const auto grids = readVdb(path, onlyNamed("grain"));
  CHECK(namesOf(grids) == std::vector<std::string>{"grain"});
  CHECK(storedDomain(*grids[0]) == ball());
  CHECK(namesOf(readVdb(path, onlyNamed("region"))) == std::vector<std::string>{"region"});
  CHECK(namesOf(readVdbHeaders(path)) == std::vector<std::string>{"region", "grain"});
  CHECK_THROWS_AS(storedDomain(*readVdbHeaders(path)[1]), InvalidInput);
  // It may share its tree with another grid.
  const auto shared = boolGrid(ball()), sharing = BoolGrid::create(shared->treePtr());
  shared->setName("object");
  sharing->setName("region");
  writeVdb(path, {shared, sharing, gridIn(ball(), "grain")});
  CHECK(storedDomain(*readVdb(path, onlyNamed("grain"))[0]) == ball());
}

TEST_CASE("region_grid: OpenVDB reads it as a grid of its own", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  writeVdb(path, {gridIn(ball(), "grain")});
  openvdb::io::File file(path);
  file.open();
  CHECK(file.readGrid("grain")->metaValue<std::string>("madf_region") == "region");
  const auto region = openvdb::gridPtrCast<BoolGrid>(file.readGrid("region"));
  file.close();
  MaskTree voxels(region->tree(), false, true, openvdb::TopologyCopy());
  CHECK(Domain(voxels) == ball());
  CHECK(region->tree().activeTileCount() > 0);
  CHECK(region->tree().getValue(Coord(0)));
}

TEST_CASE("region_grid: a region written by another program is taken", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto grain = gridNaming("core");
  const auto core = boolGrid(ball());
  core->setName("core");
  core->tree().setValue(Coord(-20), false);  // active, but not true
  writeWithOpenVdb(path, {grain, core});
  CHECK(storedDomain(*readVdb(path, onlyNamed("grain"))[0]) == ball());
  for (const char* key : {"madf_domain_min", "madf_domain_max"}) grain->removeMeta(key);
  writeWithOpenVdb(path, {grain, core});
  CHECK(storedDomain(*readVdb(path, onlyNamed("grain"))[0]) == ball());
  // One that fills its box is that box.
  core->clear();
  core->sparseFill(CoordBBox(Coord(0), Coord(7)), true, true);
  writeWithOpenVdb(path, {grain, core});
  CHECK(storedDomain(*readVdb(path, onlyNamed("grain"))[0]) ==
        Domain(CoordBBox(Coord(0), Coord(7))));
}

TEST_CASE("region_grid: a file without the region that it names is refused", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto refused = [&](const Grids& grids, const std::string& reason) {
    writeWithOpenVdb(path, grids);
    const std::string error = errorOf(path);
    requireOneLineNaming(error, path);
    CHECK_THAT(error, vdb_madf::test::Contains(reason));
    CHECK(errorOf(path, onlyNamed("region")).empty());
    CHECK_NOTHROW(readVdbHeaders(path));
  };
  refused({gridNaming("region")}, "the Bool grid 'region' that should hold it is missing");
  const auto other = boolGrid(ball());
  other->setName("core");
  refused({gridNaming("region"), other}, "'region'");
  refused({gridNaming("region"), gridIn(ball().box(), "region")}, "Bool grid");
  refused({gridNaming("region"), BoolGrid::create()}, "is missing");
  const auto empty = BoolGrid::create();
  empty->setName("region");
  refused({gridNaming("region"), empty}, "no voxel");
  refused({gridNaming("region"), boolGrid(ball(8))}, "differ");
}

TEST_CASE("region_grid: the size of a region is checked as that of any tree", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  MaskTree large;
  large.addTile(3, Coord(0), true, true);
  large.addTile(1, Coord(-8), true, true);
  const auto grid = gridIn(Domain(large), "grain");
  writeVdb(path, {grid});
  // Tiles stay tiles, so that they may hold any number of voxels, but not lie anywhere.
  CHECK(storedDomain(*readVdb(path)[0]) == Domain(large));
  VdbReadOptions options = onlyNamed("grain");
  options.maxCoordinate = 4094;
  CHECK_THAT(errorOf(path, options), vdb_madf::test::Contains("beyond coordinate"));
  // A damaged one is, whichever grid is wanted.
  std::string bytes = bytesOf(path);
  const size_t at = bytes.rfind("madf_domain_min");
  for (size_t i = at + 100; i + 100 < bytes.size(); ++i) bytes[i] = '\xff';
  writeBytes(path, bytes);
  for (const char* name : {"grain", "region"}) {
    CAPTURE(name);
    requireOneLineNaming(errorOf(path, onlyNamed(name)), path);
  }
}

TEST_CASE("region_grid: grids that one file cannot hold are refused", "[region_grid]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto refused = [&](const Grids& grids, const std::string& reason) {
    try {
      writeVdb(path, grids);
      FAIL("written");
    } catch (const InvalidInput& error) {
      CHECK_THAT(error.what(),
                 vdb_madf::test::StartsWith(path) && vdb_madf::test::Contains(reason));
    }
    CHECK(folder.entries() == 0);
  };
  const auto grain = gridIn(ball(), "grain");
  refused({grain, gridIn(ball(8), "other")}, "different regions");
  refused({grain, gridIn(ball().box(), "region")}, "give it another name");
  refused({boolGrid(ball(8)), grain}, "give it another name");
  refused({boolGrid(ball()), boolGrid(ball()), grain}, "give it another name");
}
