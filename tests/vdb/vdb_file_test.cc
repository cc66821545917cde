// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/vdb/read_vdb.h"
#include "vdb_madf/vdb/write_vdb.h"

#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <tbb/global_control.h>

#include <atomic>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"
#include "support/vdb_files.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/initialize.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using openvdb::GridBase;
namespace io = openvdb::io;

namespace {

/// Leaves full of random values: they do not compress.
Int32Grid::Ptr noise(int leaves, uint32_t seed = 1) {
  std::mt19937 random(seed);
  const auto grid = Int32Grid::create();
  for (int i = 0; i < leaves; ++i) {
    auto* leaf = grid->tree().touchLeaf(Coord(8 * (i % 16), 8 * (i / 16 % 16), 8 * (i / 256)));
    for (openvdb::Index j = 0; j < 512; ++j) leaf->setValueOn(j, int32_t(random()));
  }
  grid->setName("noise");
  return grid;
}

template <typename GridType>
bool sameTree(const GridBase& a, const GridBase& b) {
  const auto* first = dynamic_cast<const GridType*>(&a);
  const auto* second = dynamic_cast<const GridType*>(&b);
  if (!first || !second || !first->tree().hasSameTopology(second->tree())) return false;
  // Inactive values and tiles too.
  if (first->background() != second->background()) return false;
  auto i = first->tree().cbeginValueAll(), j = second->tree().cbeginValueAll();
  for (; i && j; ++i, ++j)
    if (*i != *j || i.getCoord() != j.getCoord() || i.isValueOn() != j.isValueOn()) return false;
  return !i && !j;
}

bool sameTree(const GridBase& a, const GridBase& b) {
  return sameTree<BoolGrid>(a, b) || sameTree<MaskGrid>(a, b) || sameTree<Int32Grid>(a, b) ||
         sameTree<FloatGrid>(a, b) || sameTree<Vec3sGrid>(a, b) || sameTree<DoubleGrid>(a, b) ||
         sameTree<Int64Grid>(a, b);
}

/// Metadata of `a` is in `b`.
bool hasMetadataOf(const GridBase& a, const GridBase& b) {
  for (auto i = a.beginMeta(); i != a.endMeta(); ++i) {
    const auto other = b[i->first];
    if (!other || *other != *i->second) return false;
  }
  return true;
}

bool same(const GridBase& a, const GridBase& b) {
  return a.getName() == b.getName() && sameTree(a, b) && a.transform() == b.transform() &&
         hasMetadataOf(a, b);
}

/// Stops the work at a given question.
class StopAt : public openvdb::util::NullInterrupter {
 public:
  explicit StopAt(int question) : left_(question) {}
  bool wasInterrupted(int) override {
    ++asked;
    return left_-- <= 0;
  }
  std::atomic<int> asked{0};

 private:
  std::atomic<int> left_;
};

}  // namespace

// --- round trips

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

// --- some of the grids

namespace {

VdbReadOptions onlyAmong(const std::set<std::string>& names) {
  VdbReadOptions options;
  options.wanted = [names](const GridBase& grid) { return names.count(grid.getName()) > 0; };
  return options;
}

/// The same grids in files with offsets, ours and OpenVDB's, and in one without.
std::vector<std::string> filesOf(const TemporaryFolder& folder, const Grids& grids) {
  std::vector<std::string> paths;
  for (const char* name : {"ours.vdb", "theirs.vdb", "stream.vdb"})
    paths.push_back(folder.file(name));
  writeVdb(paths[0], grids);
  writeWithOpenVdb(paths[1], grids);
  std::ostringstream out;
  io::Stream(out).write(grids);
  writeBytes(paths[2], out.str());
  return paths;
}

}  // namespace

TEST_CASE("vdb_file: of the grids those that are wanted are read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  const auto flags = ballWithTiles<BoolGrid>(Coord(4000, 0, -4), 5, "object");
  const auto surface = levelSet();
  for (const std::string& path : filesOf(folder, {labels, flags, surface})) {
    INFO(path);
    CHECK(readVdb(path, onlyAmong({})).empty());
    CHECK(readVdb(path, onlyAmong({"nothing"})).empty());
    for (const auto& grid : Grids{labels, flags, surface}) {
      const auto read = readVdb(path, onlyAmong({grid->getName()}));
      REQUIRE(read.size() == 1);
      CHECK(same(*grid, *read[0]));
    }
    const auto two = readVdb(path, onlyAmong({"surface", "grain"}));
    REQUIRE(two.size() == 2);
    CHECK(same(*labels, *two[0]));
    CHECK(same(*surface, *two[1]));
    VdbReadOptions numbers;
    numbers.wanted = [](const GridBase& grid) { return grid.isType<Int32Grid>(); };
    CHECK(readVdb(path, numbers).size() == 1);
  }
}

TEST_CASE("vdb_file: what is asked for a grid sees all but its tree", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 9, "grain");
  setVoxelSize(*labels, VoxelSize{8.5e-6});
  const auto surface = levelSet();
  const auto check = [&](const GridBase& grid) {
    const GridBase::ConstPtr stored =
        grid.getName() == "grain" ? GridBase::ConstPtr(labels) : surface;
    const GridBase& whole = *stored;
    CHECK(grid.getName() == whole.getName());
    CHECK(grid.type() == whole.type());
    CHECK(grid.transform() == whole.transform());
    CHECK(hasMetadataOf(whole, grid));
    CHECK(grid.empty());
  };
  for (const std::string& path : filesOf(folder, {labels, surface})) {
    INFO(path);
    std::vector<std::string> asked;
    VdbReadOptions options;
    options.wanted = [&](const GridBase& grid) {
      asked.push_back(grid.getName());
      check(grid);
      return true;
    };
    CHECK(readVdb(path, options).size() == 2);
    CHECK(asked == std::vector<std::string>{"grain", "surface"});
    const auto headers = readVdbHeaders(path);
    REQUIRE(headers.size() == 2);
    for (const auto& grid : headers) check(*grid);
  }
}

TEST_CASE("vdb_file: a tree that a wanted grid shares is read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto first = ballWithTiles<Int32Grid>(Coord(0), 9, "first");
  const auto other = ballWithTiles<BoolGrid>(Coord(0), 4, "other");
  const auto second = first->copyWithNewTree();
  second->setTree(first->treePtr());
  second->setName("second");
  const auto third = second->deepCopyGrid();
  third->setTree(first->treePtr());
  third->setName("third");
  for (const std::string& path : filesOf(folder, {first, other, second, third})) {
    INFO(path);
    for (const auto& grid : Grids{first, second, third}) {
      const auto grids = readVdb(path, onlyAmong({grid->getName()}));
      REQUIRE(grids.size() == 1);
      CHECK(same(*grid, *grids[0]));
    }
    const auto grids = readVdb(path, onlyAmong({"second", "third"}));
    REQUIRE(grids.size() == 2);
    CHECK(grids[0]->constBaseTreePtr() == grids[1]->constBaseTreePtr());
    CHECK(same(*third, *grids[1]));
    for (const auto& grid : readVdbHeaders(path)) CHECK(grid->empty());
  }
}

TEST_CASE("vdb_file: the tree of a grid that is not wanted is not read", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const Unverified unverified;
  const auto labels = ballWithTiles<Int32Grid>(Coord(0), 5, "grain");
  const std::string path = folder.file("a.vdb");
  writeVdb(path, {labels, noise(300)});
  std::string bytes = bytesOf(path);
  bytes.replace(bytes.size() / 2, 8000, 8000, '\xff');  // amid the noise
  writeBytes(path, bytes);
  CHECK_FALSE(errorOf(path).empty());
  CHECK_FALSE(errorOf(path, onlyAmong({"noise"})).empty());
  CHECK(errorOf(path, onlyAmong({"grain"})).empty());
  CHECK(same(*labels, *readVdb(path, onlyAmong({"grain"})).at(0)));
  CHECK(readVdbHeaders(path).size() == 2);
  // But a file that is cut is.
  writeBytes(path, bytes.substr(0, bytes.size() - 1));
  requireOneLineNaming(errorOf(path, onlyAmong({"grain"})), path);
  CHECK_THROWS_AS(readVdbHeaders(path), IoError);

  // Nor does its size count.
  const auto large = ballWithTiles<Int32Grid>(Coord(0), 5, "large", true);
  for (const std::string& file : filesOf(folder, {labels, large})) {
    INFO(file);
    VdbReadOptions options = onlyAmong({"grain"});
    options.maxVoxels = int64_t(1) << 30;
    const bool isStream = file.find("stream") != std::string::npos;  // which is walked through
    CHECK(errorOf(file, options).empty() != isStream);
    options.wanted = nullptr;
    CHECK_FALSE(errorOf(file, options).empty());
  }
}

// --- determinism

TEST_CASE("vdb_file: equal grids make equal bytes", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const auto make = [] {
    const auto labels = ballWithTiles<Int32Grid>(Coord(-5, 3, 9), 20, "grain");
    setGraph(*labels, smallGraph());
    return Grids{labels, ballWithTiles<BoolGrid>(Coord(0), 9, "object"), noise(300)};
  };
  writeVdb(folder.file("first.vdb"), make());
  const std::string bytes = bytesOf(folder.file("first.vdb"));
  for (const int threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      size_t(threads));
    writeVdb(folder.file("again.vdb"), make());
    CHECK(bytesOf(folder.file("again.vdb")) == bytes);
  }
  // What was read is written the same again.
  const auto read = readVdb(folder.file("first.vdb"));
  writeVdb(folder.file("second.vdb"), Grids(read.begin(), read.end()));
  const std::string second = bytesOf(folder.file("second.vdb"));
  const auto readAgain = readVdb(folder.file("second.vdb"));
  writeVdb(folder.file("third.vdb"), Grids(readAgain.begin(), readAgain.end()));
  CHECK(bytesOf(folder.file("third.vdb")) == second);
}

TEST_CASE("vdb_file: the UUID is well formed and tells contents apart", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  std::set<std::string> uuids;
  for (int i = 0; i < 50; ++i) {
    const auto grid = ballWithTiles<Int32Grid>(Coord(0), 3, "grain");
    // One bit of a value, or of the topology.
    if (i % 2) grid->tree().setValueOnly(Coord(1, 0, 0), i);
    grid->tree().setActiveState(Coord(-30 - i, 0, 0), true);
    const std::string path = folder.file("a.vdb");
    writeVdb(path, {grid});
    const std::string uuid = bytesOf(path).substr(21, 36);
    REQUIRE(uuid.find_first_not_of("0123456789abcdef-") == std::string::npos);
    for (const int hyphen : {8, 13, 18, 23}) REQUIRE(uuid[size_t(hyphen)] == '-');
    REQUIRE(uuid[14] == '8');
    REQUIRE(std::string("89ab").find(uuid[19]) != std::string::npos);
    uuids.insert(uuid);
    io::File file(path);
    file.open();
    REQUIRE(file.getUniqueTag() == uuid);
  }
  REQUIRE(uuids.size() == 50);
}

// --- files that cannot be written

TEST_CASE("vdb_file: a full disk is noticed and leaves the old file", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  const auto grid = noise(400);  // about 800 KiB
  writeVdb(path, {grid});
  const int64_t size = int64_t(std::filesystem::file_size(path));
  writeBytes(path, "old");
  for (const int64_t limit :
       {int64_t(0), int64_t(1), int64_t(40), int64_t(5000), size / 4, size / 2, size - 1}) {
    INFO("limit " << limit);
    std::string error;
    {
      const FullDisk disk{rlim_t(limit)};
      try {
        writeVdb(path, {grid});
      } catch (const IoError& caught) {
        error = caught.what();
      }
    }
    requireOneLineNaming(error, path);
    CHECK(bytesOf(path) == "old");
    CHECK(folder.entries() == 1);
  }
  {
    const FullDisk disk{rlim_t(size)};
    writeVdb(path, {grid});
  }
  CHECK(same(*grid, *readVdb(path).at(0)));
}

TEST_CASE("vdb_file: a place where no file can be is refused by name", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  writeBytes(folder.file("file"), "old");
  const auto refused = [](const std::string& path) {
    try {
      writeVdb(path, {noise(1)});
      FAIL("it was written");
    } catch (const IoError& error) {
      requireOneLineNaming(error.what(), path);
    }
  };
  refused(folder.file("missing/a.vdb"));
  refused(folder.file("file/a.vdb"));
  refused(folder.path());
  refused("/dev/full");
  CHECK(folder.entries() == 1);
  CHECK(bytesOf(folder.file("file")) == "old");
}

TEST_CASE("vdb_file: stops when interrupted, without a trace", "[vdb_file]") {
  initialize();
  const TemporaryFolder folder;
  const std::string path = folder.file("a.vdb");
  writeBytes(path, "old");
  const Grids grids{noise(300, 1), noise(300, 2)};
  StopAt never(1 << 30);
  writeVdb(folder.file("whole.vdb"), grids, &never);
  REQUIRE(never.asked >= 4);
  for (int question = 0; question < never.asked; ++question) {
    StopAt stop(question);
    REQUIRE_THROWS_AS(writeVdb(path, grids, &stop), Interrupted);
    CHECK(bytesOf(path) == "old");
    CHECK(folder.entries() == 2);
  }
}
