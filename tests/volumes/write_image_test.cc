// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <limits>
#include <random>

#include "support/catch.h"
#include "support/files.h"
#include "support/full_disk.h"
#include "support/images.h"
#include "support/other_grids.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/method/boundary.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/read_mask.h"
#include "vdb_madf/volumes/image_losses.h"
#include "vdb_madf/volumes/label_type.h"
#include "vdb_madf/volumes/write_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

template <typename Value>
using GridOf = openvdb::Grid<StandardTree<Value>>;

/// Small numbers in voxels and tiles, active or not.
template <typename Value>
typename GridOf<Value>::Ptr randomGrid(unsigned seed, int background) {
  using Stored = typename GridOf<Value>::ValueType;
  std::mt19937 random(seed);
  const auto grid = GridOf<Value>::create(Stored(background));
  const auto place = [&] {
    return Coord(int(random() % 60) - 30, int(random() % 50) - 10, int(random() % 40) - 20);
  };
  for (int i = 0; i < 10; ++i)
    grid->tree().addTile(1, place(), Stored(random() % 100), random() % 2 != 0);
  for (int i = 0; i < 4000; ++i)
    if (random() % 3)
      grid->tree().setValue(place(), Stored(random() % 100));
    else
      grid->tree().setValueOff(place(), Stored(random() % 100));
  grid->tree().addTile(2, Coord(128, 0, 0), Stored(7), true);
  return grid;
}

/// The file's samples as numbers.
std::vector<double> numbersIn(const std::string& path, const std::optional<RawLayout>& raw) {
  const auto image = openImage(path, raw);
  const std::string bytes = readAll(*image);
  std::vector<double> numbers;
  const size_t size = sampleSize(image->info().type);
  for (size_t i = 0; i < bytes.size(); i += size) {
    const auto as = [&](auto value) {
      std::memcpy(&value, &bytes[i], sizeof value);
      return double(value);
    };
    switch (image->info().type) {
      case SampleType::uint8:
        numbers.push_back(as(uint8_t()));
        break;
      case SampleType::int8:
        numbers.push_back(as(int8_t()));
        break;
      case SampleType::uint16:
        numbers.push_back(as(uint16_t()));
        break;
      case SampleType::int16:
        numbers.push_back(as(int16_t()));
        break;
      case SampleType::uint32:
        numbers.push_back(as(uint32_t()));
        break;
      case SampleType::int32:
        numbers.push_back(as(int32_t()));
        break;
      case SampleType::float32:
        numbers.push_back(as(float()));
        break;
      case SampleType::float64:
        numbers.push_back(as(double()));
        break;
    }
  }
  return numbers;
}

template <typename Value>
void checkBoxes(const ScratchFolder& folder) {
  const auto grid = randomGrid<Value>(11, std::is_same_v<Value, openvdb::ValueMask> ? 0 : 1);
  const auto voxels = grid->getConstAccessor();
  const auto valueAt = [&](const Coord& p) {
    const bool counts = std::is_floating_point_v<Value> || voxels.isValueOn(p);
    return counts ? double(voxels.getValue(p)) : 0;
  };
  for (const CoordBBox& box :
       {CoordBBox(Coord(-21, -11, -13), Coord(20, 31, 18)), CoordBBox(Coord(0), Coord(7)),
        CoordBBox(Coord(-3, 5, -9), Coord(-3, 5, 13)), CoordBBox(Coord(-5, -5, 6), Coord(20, 3, 9)),
        CoordBBox(Coord(120, -2, 100), Coord(140, 3, 130)),
        CoordBBox(Coord(5000, 5000, 5000), Coord(5002, 5003, 5004))})
    for (const SampleType type : kSampleTypes) {
      CAPTURE(grid->valueType(), box, sampleTypeName(type));
      const std::string path = folder / "a.raw";
      writeImage(path, *grid, box, type);
      const auto numbers = numbersIn(path, RawLayout{toImageSize(box.dim()), type, false});
      REQUIRE(numbers.size() == box.volume());
      size_t i = 0, wrong = 0;
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        for (int y = box.min().y(); y <= box.max().y(); ++y)
          for (int x = box.min().x(); x <= box.max().x(); ++x)
            wrong += numbers[i++] != valueAt(Coord(x, y, z));
      REQUIRE(wrong == 0);
    }
}

template <typename Value>
void write(const ScratchFolder& folder, Value value, SampleType type) {
  const auto grid = GridOf<Value>::create(Value(0));
  grid->tree().setValue(Coord(3, 3, 12), value);
  writeImage(folder / "a.raw", *grid, CoordBBox(Coord(0), Coord(15)), type);
}

}  // namespace

TEST_CASE("image_write: equals the grid voxel by voxel", "[image_write]") {
  const ScratchFolder folder;
  checkBoxes<bool>(folder);
  checkBoxes<openvdb::ValueMask>(folder);
  checkBoxes<int32_t>(folder);
  checkBoxes<int64_t>(folder);
  checkBoxes<float>(folder);
  checkBoxes<double>(folder);
}

TEST_CASE("image_write: every format, with the voxel size", "[image_write]") {
  const ScratchFolder folder;
  const auto grid = randomGrid<int32_t>(12, 0);
  setVoxelSize(*grid, VoxelSize{8.5e-6});
  const CoordBBox box(Coord(-20, -5, -13), Coord(11, 22, 9));
  writeImage(folder / "a.raw", *grid, box, SampleType::int32);
  const auto numbers =
      numbersIn(folder / "a.raw", RawLayout{toImageSize(box.dim()), SampleType::int32, false});
  for (const std::string name : {"b.mhd", "b.mha", "b.tif", "b.nrrd"}) {
    writeImage(folder / name, *grid, box, SampleType::int32);
    CHECK(numbersIn(folder / name, std::nullopt) == numbers);
    CHECK(openImage(folder / name)->info().voxelSize->edge() == 8.5e-6);
  }
}

TEST_CASE("image_write: a mask comes back as it went", "[image_write]") {
  const ScratchFolder folder;
  const auto grid = randomGrid<openvdb::ValueMask>(13, 0);
  const CoordBBox box(Coord(0), Coord(40, 39, 38));
  writeImage(folder / "a.tif", *grid, box, SampleType::uint8);
  const auto mask = readMask(*openImage(folder / "a.tif"));
  CHECK(storedDomain(*mask) == box);
  size_t wrong = 0;
  for (auto p = box.begin(); p != box.end(); ++p)
    wrong += mask->tree().isValueOn(*p) != grid->tree().isValueOn(*p);
  CHECK(wrong == 0);
}

TEST_CASE("image_write: a value that does not fit is an error that names it", "[image_write]") {
  const ScratchFolder folder;
  const auto refuses = [&](auto value, SampleType type, const std::string& text) {
    CAPTURE(text, sampleTypeName(type));
    CHECK_THROWS_WITH(write(folder, value, type), Contains(" " + text + " ") &&
                                                      Contains(sampleTypeName(type)) &&
                                                      Contains(folder / "a.raw"));
    CHECK_THROWS_AS(write(folder, value, type), InvalidInput);
    CHECK(folder.fileCount() == 0);
  };
  refuses(int32_t(256), SampleType::uint8, "256");
  refuses(int32_t(-1), SampleType::uint16, "-1");
  refuses(int32_t(128), SampleType::int8, "128");
  refuses(int32_t(16777217), SampleType::float32, "16777217");
  refuses(int64_t(1) << 32, SampleType::uint32, "4294967296");
  refuses(int64_t(1) << 31, SampleType::int32, "2147483648");
  refuses((int64_t(1) << 53) + 1, SampleType::float64, "9007199254740993");
  refuses(0.5F, SampleType::uint8, "0.5");
  refuses(std::numeric_limits<float>::quiet_NaN(), SampleType::int32, "nan");
  refuses(2147483648.0F, SampleType::int32, "2147483648");
  refuses(1e39, SampleType::float32, "1e+39");
  write(folder, 2147483520.0F, SampleType::int32);
  write(folder, int64_t(4294967295), SampleType::uint32);
  write(folder, 0.1, SampleType::float32);
  write(folder, std::numeric_limits<double>::infinity(), SampleType::float32);
  write(folder, std::numeric_limits<double>::quiet_NaN(), SampleType::float32);
  write(folder, int32_t(-128), SampleType::int8);
  CHECK(folder.fileCount() == 1);
}

TEST_CASE("image_write: what is not there to write is refused", "[image_write]") {
  const ScratchFolder folder;
  const auto grid = Int32Grid::create(0);
  CHECK_THROWS_AS(writeImage(folder / "a.raw", *grid, CoordBBox(), SampleType::uint8),
                  InvalidInput);
  CHECK_THROWS_AS(
      writeImage(folder / "a.vdb", *grid, CoordBBox(Coord(0), Coord(1)), SampleType::uint8),
      InvalidInput);
  const auto vectors = test::Vec3sGrid::create();
  CHECK_THROWS_AS(
      writeImage(folder / "a.raw", *vectors, CoordBBox(Coord(0), Coord(1)), SampleType::uint8),
      InvalidInput);
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("image_write: labels take the smallest unsigned type that programs expect",
          "[image_write]") {
  const auto grid = Int32Grid::create(0);
  CHECK(labelType(*grid) == SampleType::uint16);
  grid->tree().setValue(Coord(1, 2, 3), 65535);
  CHECK(labelType(*grid) == SampleType::uint16);
  grid->tree().setValueOff(Coord(100, 2, 3), -5);  // inactive values are none
  CHECK(labelType(*grid) == SampleType::uint16);
  grid->tree().setValue(Coord(101, 2, 3), 65536);
  CHECK(labelType(*grid) == SampleType::uint32);
  grid->tree().setValue(Coord(-1000, 2, 3), -1);
  CHECK(labelType(*grid) == SampleType::int32);
  const auto tiles = Int32Grid::create(0);
  tiles->tree().addTile(2, Coord(0), 70000, true);
  CHECK(labelType(*tiles) == SampleType::uint32);
  tiles->tree().addTile(1, Coord(1024, 0, 0), -5, true);
  CHECK(labelType(*tiles) == SampleType::int32);
  CHECK(labelType(*Int32Grid::create(-1)) == SampleType::uint16);
}

TEST_CASE("image_write: labels and masks that leave their domain are refused", "[image_write]") {
  const auto check = [](auto grid) {
    grid->tree().setValueOn(Coord(0, 0, 3));
    grid->tree().setValueOn(Coord(15, 7, 7));
    CHECK(writtenBox(*grid) == CoordBBox(Coord(0, 0, 3), Coord(15, 7, 7)));
    setDomain(*grid, CoordBBox(Coord(0), Coord(15)));
    CHECK(writtenBox(*grid) == CoordBBox(Coord(0), Coord(15)));
    setDomain(*grid, CoordBBox(Coord(0), Coord(9)));
    CHECK_THROWS_WITH(writtenBox(*grid), Contains("leaves the domain"));
  };
  check(Int32Grid::create(1));
  check(MaskGrid::create());
  const auto band = FloatGrid::create(1);  // of a level set, which may reach beyond
  band->tree().setValueOn(Coord(20));
  setDomain(*band, CoordBBox(Coord(0), Coord(9)));
  CHECK(writtenBox(*band) == CoordBBox(Coord(0), Coord(9)));

  const ScratchFolder folder;
  LabelSlabs slabs;
  const auto about = Int32Grid::create(0);
  setDomain(*about, CoordBBox(Coord(0), Coord(9)));
  slabs.about = about;
  slabs.cuts = {0, 8};
  slabs.read = [](size_t, Interrupter*) {
    const auto slab = Int32Grid::create(0);
    slab->tree().setValue(Coord(12, 0, 0), 1);
    return slab;
  };
  CHECK_THROWS_WITH(
      writeImage(folder / "a.raw", slabs, CoordBBox(Coord(0), Coord(9)), SampleType::int32),
      Contains("leaves the domain"));
  CHECK(folder.fileCount() == 0);
}

TEST_CASE("image_write: what a file does not hold is said", "[image_write]") {
  const auto grid = Int32Grid::create(0);
  setDomain(*grid, CoordBBox(Coord(0), Coord(7)));
  setVoxelSize(*grid, VoxelSize({1e-5, 1e-5, 2e-5}));
  CHECK(lossesOf("a.tif", *grid).empty());
  CHECK(lossesOf("a.raw", *grid) ==
        std::vector<std::string>{"a.raw: does not say that its voxels are no cubes: give their "
                                 "edges again where it is read (--voxel-size)"});
  // Of reduced labels the center of the first voxel lies between those of the scan.
  grid->transform().postTranslate(openvdb::Vec3d(0.005, 0.005, 0.01));
  CHECK(lossesOf("a.mha", *grid).empty());
  CHECK(lossesOf("a.h5", *grid) ==
        std::vector<std::string>{"a.h5: the center of its first voxel is at 0.005,0.005,0.01 mm, "
                                 "and where it is read at 0 (a .vdb keeps the place)"});
  CHECK(lostEdges("a.mha", true, VoxelSize(2e-3)).empty());
  CHECK(lostEdges("a.nrrd", true, VoxelSize(1e-3)).empty());
  CHECK_THAT(lostEdges("a.mha", true, VoxelSize(1e-3)), Contains("1 mm"));
  setBoundary(*grid, Boundary::open);
  CHECK(lossesOf("a.mha", *grid).empty());
  setBoundary(*grid, Boundary::closed);
  CHECK(lossesOf("a.mha", *grid) ==
        std::vector<std::string>{"a.mha: does not say that the boundary is closed: give that again "
                                 "where it is read (--boundary closed; a .vdb says it)"});
}

TEST_CASE("image_write: interrupted or out of space, nothing remains", "[image_write]") {
  const ScratchFolder folder;
  const auto grid = randomGrid<int32_t>(14, 0);
  const CoordBBox box(Coord(-30, -10, -20), Coord(70, 80, 79));
  std::vector<std::string> names = {"a.raw", "a.mhd", "a.mha", "a.tif", "a.nrrd", "a.npy"};
  if (readsHdf5()) names.push_back("a.h5");
  for (const std::string& name : names) {
    CAPTURE(name);
    StopAfter three(3);
    CHECK_THROWS_AS(writeImage(folder / name, *grid, box, SampleType::int32, &three), Interrupted);
    CHECK(folder.fileCount() == 0);
    {
      const FullDisk full(3000);
      const CapturedStderr quiet("/dev/null");
      CHECK_THROWS_AS(writeImage(folder / name, *grid, box, SampleType::int32), IoError);
    }
    CHECK(folder.fileCount() == 0);
  }
}
