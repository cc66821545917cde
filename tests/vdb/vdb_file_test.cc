// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

// What is written is read as it was, by us and by OpenVDB.

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>

#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/same_grids.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"
#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
namespace io = openvdb::io;

TEMPLATE_TEST_CASE("vdb_file: a grid comes back as it was", "[vdb_file]", BoolGrid, MaskGrid,
                   Int32Grid, Int64Grid, FloatGrid, DoubleGrid, Vec3sGrid) {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("grid.vdb");
  const auto empty = TestType::create();
  empty->setName("empty");
  const auto ball = ballWithTiles<TestType>(Coord(-100, 20, -4099), 9, "ball");
  ball->insertMeta("text", openvdb::StringMetadata("several\nlines"));
  ball->insertMeta("number", openvdb::DoubleMetadata(0.1));
  setDomain(*ball, CoordBBox(Coord(-150), Coord(400)));
  setVoxelSize(*ball, VoxelSize{8.5e-6});
  writeVdb(path, {empty, ball});
  const auto grids = readVdb(path);
  REQUIRE(grids.size() == 2);
  CHECK(same(*empty, *grids[0]));
  CHECK(same(*ball, *grids[1]));
  CHECK(grids[1]->metaValue<std::string>("text") == "several\nlines");
  CHECK(storedVoxelSize(*grids[1])->edge() == 8.5e-6);
  CHECK(folder.entries() == 1);

  // The comparison sees a value that differs, inactive or not.
  const auto other = ball->deepCopy();
  other->tree().setValueOff(Coord(-100, 20, -4099),
                            valueAt<typename TestType::ValueType>(Coord(1, 0, 0)));
  CHECK_FALSE(sameTree(*ball, *other));
}

TEST_CASE("vdb_file: a file without grids is read", "[vdb_file]") {
  const TemporaryFolder folder;
  writeVdb(folder.file("none.vdb"), {});
  REQUIRE(readVdb(folder.file("none.vdb")).empty());
}

TEST_CASE("vdb_file: the graph of the manifolds comes back", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto grid = ballWithTiles<Int32Grid>(Coord(0), 3, "manifold");
  setGraph(*grid, smallGraph());
  writeVdb(folder.file("graph.vdb"), {grid});
  const auto read = storedGraph(*readVdb(folder.file("graph.vdb")).at(0));
  REQUIRE(read);
  REQUIRE(read->nodes == smallGraph().nodes);
  REQUIRE(read->edges == smallGraph().edges);
}

TEST_CASE("vdb_file: grids of one name stay apart, in the order of writing", "[vdb_file]") {
  const TemporaryFolder folder;
  const auto z = ballWithTiles<Int32Grid>(Coord(0), 2, "z");
  const auto first = ballWithTiles<Int32Grid>(Coord(0), 3, "a");
  const auto second = ballWithTiles<Int32Grid>(Coord(0), 4, "a");
  const auto nameless = ballWithTiles<Int32Grid>(Coord(0), 5, "");
  writeVdb(folder.file("names.vdb"), {z, first, second, nameless});
  const auto grids = readVdb(folder.file("names.vdb"));
  REQUIRE(grids.size() == 4);
  CHECK(same(*z, *grids[0]));
  CHECK(same(*first, *grids[1]));
  CHECK(same(*second, *grids[2]));
  CHECK(same(*nameless, *grids[3]));
}

TEST_CASE("vdb_file: OpenVDB reads what we write", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("ours.vdb");
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain", true);
  const auto surface = levelSet();
  writeVdb(path, {labels, surface});
  io::File file(path);
  file.open();
  CHECK(file.hasGrid("grain"));
  CHECK(same(*labels, *file.readGrid("grain")));  // by its offset
  CHECK(same(*surface, *file.readGrid("surface")));
  file.close();
}

TEST_CASE("vdb_file: we read what OpenVDB writes", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  const auto flags = ballWithTiles<BoolGrid>(Coord(4000, 0, -4), 5, "object");
  const auto mask = ballWithTiles<MaskGrid>(Coord(0, -8, 0), 5, "mask");
  const auto colors = ballWithTiles<Vec3sGrid>(Coord(1, 2, 3), 9, "color");
  const auto frustum = FloatGrid::create();
  frustum->tree().setValue(Coord(1, 2, 3), 4.0f);
  frustum->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(100)), 0.3, 10, 0.1));
  const Grids grids{labels, flags, mask, colors, levelSet(), frustum};
  VdbReadOptions anyShape;
  anyShape.anyVoxelShape = true;
  for (uint32_t compression = 0; compression < 8; ++compression) {
    INFO("compression " << compression);
    const std::string path = folder.file("other.vdb");
    writeWithOpenVdb(path, grids, compression);
    const auto read = readVdb(path, anyShape);
    REQUIRE(read.size() == grids.size());
    for (size_t i = 0; i < grids.size(); ++i) CHECK(same(*grids[i], *read[i]));

    // Without offsets.
    std::ostringstream out;
    io::Stream stream(out);
    stream.setCompression(compression);
    stream.write(grids);
    writeBytes(path, out.str());
    const auto streamed = readVdb(path, anyShape);
    REQUIRE(streamed.size() == grids.size());
    for (size_t i = 0; i < grids.size(); ++i) CHECK(same(*grids[i], *streamed[i]));
  }
}

TEST_CASE("vdb_file: half floats are read as OpenVDB reads them", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto scalars = ballWithTiles<FloatGrid>(Coord(0), 9, "float");
  const auto doubles = ballWithTiles<DoubleGrid>(Coord(0), 9, "double");
  const auto vectors = ballWithTiles<Vec3sGrid>(Coord(0), 9, "vector");
  const auto integers = ballWithTiles<Int32Grid>(Coord(0), 9, "integer");
  for (const auto& grid : std::vector<GridBase::Ptr>{scalars, doubles, vectors, integers})
    grid->setSaveFloatAsHalf(true);
  for (uint32_t compression = 0; compression < 8; ++compression) {
    INFO("compression " << compression);
    const std::string path = folder.file("half.vdb");
    writeWithOpenVdb(path, {scalars, doubles, vectors, integers}, compression);
    io::File file(path);
    file.open(/*delayLoad=*/false);
    for (const auto& grid : readVdb(path)) CHECK(same(*file.readGrid(grid->getName()), *grid));
  }
}

TEST_CASE("vdb_file: grids that share a tree still do", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto first = ballWithTiles<Int32Grid>(Coord(0), 9, "first");
  const auto second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  writeWithOpenVdb(folder.file("shared.vdb"), {first, second});
  writeVdb(folder.file("ours.vdb"), {first, second});
  for (const char* name : {"shared.vdb", "ours.vdb"}) {
    const auto grids = readVdb(folder.file(name));
    REQUIRE(grids.size() == 2);
    CHECK(grids[0]->constBaseTreePtr() == grids[1]->constBaseTreePtr());
    CHECK(same(*first, *grids[0]));
    CHECK(same(*second, *grids[1]));
  }
}

TEST_CASE("vdb_file: grids that are no volumes are left out", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto points = GridBase::createGrid("Tree_ptdataidx32_5_4_3");
  points->setName("points");
  const auto labels = ballWithTiles<Int32Grid>(Coord(0), 3, "grain");
  writeWithOpenVdb(folder.file("points.vdb"), {points, labels});
  const auto grids = readVdb(folder.file("points.vdb"));
  REQUIRE(grids.size() == 1);
  CHECK(same(*labels, *grids[0]));
}

TEST_CASE("vdb_file: unknown metadata is carried along", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto grid = ballWithTiles<Int32Grid>(Coord(0), 3, "grain");
  openvdb::UnknownMetadata unknown("someone_elses");
  unknown.setValue({1, 2, 3, 0, 255});
  grid->insertMeta("theirs", unknown);
  writeVdb(folder.file("a.vdb"), {grid});
  const auto read = readVdb(folder.file("a.vdb"));
  REQUIRE((*read[0])["theirs"]);
  CHECK(*(*read[0])["theirs"] == unknown);
  CHECK((*read[0])["theirs"]->typeName() == "someone_elses");
}
