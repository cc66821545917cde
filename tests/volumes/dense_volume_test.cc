// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/dense_volume.h"

#include <cmath>
#include <random>

#include "support/catch.h"
#include "support/files.h"
#include "support/images.h"
#include "support/other_grids.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/read_mask.h"
#include "vdb_madf/volumes/read_labels.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

using Strides = std::array<int64_t, 3>;

CoordBBox boxAt(const Coord& first, const Coord& size) {
  return {first, first + size.offsetBy(-1)};
}

/// Odd sizes, corners on all sides of the borders of leaves.
std::vector<CoordBBox> boxes() {
  return {boxAt(Coord(0), Coord(1)),
          boxAt(Coord(-1), Coord(1)),
          boxAt(Coord(0), Coord(8)),
          boxAt(Coord(-8, 16, 0), Coord(8, 16, 24)),
          boxAt(Coord(-3, 5, -9), Coord(9, 11, 17)),
          boxAt(Coord(7, -17, -4), Coord(33, 2, 3)),
          boxAt(Coord(-31, -2, 1), Coord(1, 25, 20)),
          boxAt(Coord(5, 6, 7), Coord(64, 1, 9)),
          boxAt(Coord(-100000001, 100000003, -5), Coord(5, 6, 12))};
}

/// x fastest; z fastest; y fastest with gaps; from the last voxel of the memory back to the first.
std::vector<std::optional<Strides>> stridesOf(const Coord& size) {
  const int64_t nx = size.x(), ny = size.y(), nz = size.z();
  return {std::nullopt, Strides{1, nx, nx * ny}, Strides{ny * nz, nz, 1},
          Strides{3 * ny + 1, 3, (3 * ny + 1) * nx + 5}, Strides{-1, -nx, -nx * ny}};
}

/// A number as a sample of the type.
void setSample(void* samples, int64_t place, SampleType type, double value) {
  const auto as = [&](auto sample) {
    static_cast<decltype(sample)*>(samples)[place] = decltype(sample)(value);
  };
  switch (type) {
    case SampleType::uint8:
      return as(uint8_t());
    case SampleType::int8:
      return as(int8_t());
    case SampleType::uint16:
      return as(uint16_t());
    case SampleType::int16:
      return as(int16_t());
    case SampleType::uint32:
      return as(uint32_t());
    case SampleType::int32:
      return as(int32_t());
    case SampleType::float32:
      return as(float());
    case SampleType::float64:
      return as(double());
  }
}

/// A box of small numbers in memory, with something else in the gaps.
struct Array {
  Array(const CoordBBox& box, SampleType type, const std::optional<Strides>& strides, unsigned seed)
      : layout{type, box, strides}, values(box.volume()) {
    const Coord size = box.dim();
    const Strides steps = strides.value_or(Strides{1, size.x(), int64_t(size.x()) * size.y()});
    int64_t last = 0, before = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t span = steps[size_t(axis)] * (size[axis] - 1);
      span > 0 ? last += span : before -= span;
    }
    memory.resize(size_t(before + last + 1) * sampleSize(type) / sizeof(double) + 1, 0.1);
    first = reinterpret_cast<char*>(memory.data()) + size_t(before) * sampleSize(type);
    std::mt19937 random(seed);
    size_t i = 0;
    for (int z = 0; z < size.z(); ++z)
      for (int y = 0; y < size.y(); ++y)
        for (int x = 0; x < size.x(); ++x, ++i) {
          values[i] = random() % 2 ? 0 : double(1 + random() % 9);
          places.push_back(x * steps[0] + y * steps[1] + z * steps[2]);
          setSample(first, places[i], type, values[i]);
        }
  }
  Array(const Array&) = delete;

  double& at(const Coord& p) {
    const Coord size = layout.box.dim(), d = p - layout.box.min();
    return values[(size_t(d.z()) * size_t(size.y()) + size_t(d.y())) * size_t(size.x()) +
                  size_t(d.x())];
  }

  DenseLayout layout;
  std::vector<double> values;  ///< x fastest
  std::vector<int64_t> places;
  std::vector<double> memory;
  void* first;  ///< the sample of the lower corner
};

/// f(array) for boxes, types and strides.
template <typename F>
void forEachArray(const F& f) {
  unsigned seed = 0;
  for (const CoordBBox& box : boxes())
    for (const SampleType type : kSampleTypes)
      for (const auto& strides : stridesOf(box.dim())) {
        ++seed;
        CAPTURE(seed, box, sampleTypeName(type), strides.value_or(Strides{}));
        Array array(box, type, strides, seed);
        f(array);
      }
}

/// Voxels at which the grid is not what the array says of them; those outside of it, too.
template <typename Grid, typename IsActive>
size_t differences(const Grid& grid, Array& array, const IsActive& isActive) {
  size_t wrong = 0, active = 0;
  const auto voxels = grid.getConstAccessor();
  for (auto p = array.layout.box.begin(); p; ++p) {
    const double value = array.at(*p);
    active += isActive(value);
    wrong += voxels.isValueOn(*p) != isActive(value);
    if constexpr (std::is_same_v<Grid, Int32Grid>) wrong += voxels.getValue(*p) != int32_t(value);
  }
  return wrong + (grid.activeVoxelCount() != active);
}

bool isLabel(double value) {
  return value != 0;
}

class RecordingStop : public Interrupter {
 public:
  explicit RecordingStop(int polls) : left_(polls) {}
  bool wasInterrupted(int percent) override {
    percents.push_back(percent);
    return left_-- <= 0;
  }
  std::vector<int> percents;

 private:
  int left_;
};

}  // namespace

TEST_CASE("dense_volume: a mask equals the array voxel by voxel", "[dense_volume]") {
  const Selection selection = Selection::range(2, 6.5);
  forEachArray([&](Array& array) {
    const auto mask = maskFromDense(array.first, array.layout, selection);
    REQUIRE(differences(*mask, array, selection) == 0);
    for (auto leaf = mask->tree().cbeginLeaf(); leaf; ++leaf) REQUIRE_FALSE(leaf->isEmpty());
    REQUIRE(storedDomain(*mask) == array.layout.box);
    // The comparison sees one voxel.
    const Coord last = array.layout.box.max();
    mask->tree().setActiveState(last, !mask->tree().isValueOn(last));
    REQUIRE(differences(*mask, array, selection) != 0);
  });
}

TEST_CASE("dense_volume: labels equal the array voxel by voxel", "[dense_volume]") {
  forEachArray([](Array& array) {
    const auto labels = labelsFromDense(array.first, array.layout);
    REQUIRE(differences(*labels, array, isLabel) == 0);
    REQUIRE(storedDomain(*labels) == array.layout.box);
    array.at(array.layout.box.min()) += 1;
    REQUIRE(differences(*labels, array, isLabel) != 0);
  });
}

TEST_CASE("dense_volume: labels come back as they went, and gaps are left alone",
          "[dense_volume]") {
  forEachArray([](Array& array) {
    const auto labels = labelsFromDense(array.first, array.layout);
    const std::vector<double> before = array.memory;
    for (const int64_t place : array.places) setSample(array.first, place, array.layout.type, 77);
    REQUIRE(array.memory != before);
    copyToDense(*labels, array.first, array.layout);
    REQUIRE(array.memory == before);
  });
}

TEST_CASE("dense_volume: a mask comes back as zeros and ones, cropped or padded",
          "[dense_volume]") {
  Array array(boxAt(Coord(-3, 5, -9), Coord(9, 11, 17)), SampleType::uint16, std::nullopt, 3);
  const auto mask = maskFromDense(array.first, array.layout);
  mask->tree().addTile(1, Coord(16, 0, 0), true, true);
  for (const CoordBBox& box :
       {array.layout.box, boxAt(Coord(-1, 7, -7), Coord(3)), boxAt(Coord(-10), Coord(41, 33, 29))})
    for (const auto& strides : stridesOf(box.dim())) {
      CAPTURE(box, strides.value_or(Strides{}));
      Array back(box, SampleType::uint8, strides, 4);
      copyToDense(*mask, back.first, back.layout);
      size_t i = 0, wrong = 0;
      for (int z = box.min().z(); z <= box.max().z(); ++z)
        for (int y = box.min().y(); y <= box.max().y(); ++y)
          for (int x = box.min().x(); x <= box.max().x(); ++x, ++i)
            wrong += static_cast<uint8_t*>(back.first)[back.places[i]] !=
                     uint8_t(mask->tree().isValueOn(Coord(x, y, z)));
      CHECK(wrong == 0);
    }
}

TEST_CASE("dense_volume: an array and a file of the same samples give the same grids",
          "[dense_volume]") {
  const ScratchFolder folder;
  const ImageSize size{19, 10, 21};
  for (const SampleType type : kSampleTypes) {
    CAPTURE(sampleTypeName(type));
    const std::string bytes = randomSamples(type, voxels(size), 11);
    writeFile(folder / "a.raw", bytes);
    const DenseLayout layout{type, imageBox(size), std::nullopt};
    for (const Selection& selection :
         {Selection{}, Selection::phase(1), Selection::threshold(100.5)}) {
      const auto read =
          readMask(*openImage(folder / "a.raw", RawLayout{size, type, false}), selection);
      const auto mask = maskFromDense(bytes.data(), layout, selection);
      CHECK(mask->getName() == read->getName());
      CHECK(storedDomain(*mask) == storedDomain(*read));
      CHECK(mask->tree().hasSameTopology(read->tree()));
    }
    if (type == SampleType::uint32 || type == SampleType::float32 || type == SampleType::float64)
      continue;  // random numbers that are no labels
    const auto read = readLabels(*openImage(folder / "a.raw", RawLayout{size, type, false}));
    const auto labels = labelsFromDense(bytes.data(), layout);
    CHECK(labels->tree().hasSameTopology(read->tree()));
    for (auto voxel = read->cbeginValueOn(); voxel; ++voxel)
      REQUIRE(labels->tree().getValue(voxel.getCoord()) == *voxel);
  }
}

TEST_CASE("dense_volume: nothing but zeros gives empty grids with their domain and voxel size",
          "[dense_volume]") {
  const CoordBBox box = boxAt(Coord(-4, 3, 9), Coord(5, 6, 7));
  const std::vector<uint8_t> zeros(box.volume());
  const DenseLayout layout{SampleType::uint8, box, std::nullopt};
  const auto mask = maskFromDense(zeros.data(), layout, {}, VoxelSize{8.5e-6});
  const auto labels = labelsFromDense(zeros.data(), layout, VoxelSize{8.5e-6});
  for (const openvdb::GridBase::ConstPtr& grid :
       {openvdb::GridBase::ConstPtr(mask), openvdb::GridBase::ConstPtr(labels)}) {
    CHECK(grid->empty());
    CHECK(storedDomain(*grid) == box);
    CHECK(storedVoxelSize(*grid)->edge() == 8.5e-6);
    CHECK(grid->voxelSize()[0] == Approx(0.0085));
  }
  CHECK_FALSE(storedVoxelSize(*maskFromDense(zeros.data(), layout)));
}

TEST_CASE("dense_volume: what cannot be is refused", "[dense_volume]") {
  std::vector<float> samples(8, 0.5F);
  DenseLayout layout{SampleType::float32, boxAt(Coord(0), Coord(2)), std::nullopt};
  CHECK_THROWS_WITH(labelsFromDense(samples.data(), layout),
                    Contains("the array") && Contains(" 0.5 "));
  CHECK_THROWS_AS(labelsFromDense(samples.data(), layout), InvalidInput);

  const auto grid = Int32Grid::create(0);
  grid->tree().setValue(Coord(1), 256);
  layout.type = SampleType::uint8;
  CHECK_THROWS_WITH(copyToDense(*grid, samples.data(), layout),
                    Contains("the array") && Contains(" 256 ") && Contains("uint8"));
  const auto vectors = test::Vec3sGrid::create();
  CHECK_THROWS_AS(copyToDense(*vectors, samples.data(), layout), InvalidInput);

  for (const CoordBBox& box :
       {CoordBBox(), boxAt(Coord(0), Coord(2, 0, 2)), boxAt(Coord(kMaxCoordinate), Coord(2)),
        boxAt(Coord(0, -kMaxCoordinate - 1, 0), Coord(2))}) {
    CAPTURE(box);
    layout.box = box;
    CHECK_THROWS_AS(maskFromDense(samples.data(), layout), InvalidInput);
    CHECK_THROWS_AS(labelsFromDense(samples.data(), layout), InvalidInput);
    CHECK_THROWS_AS(copyToDense(*grid, samples.data(), layout), InvalidInput);
  }
  layout.type = SampleType::float32;
  layout.box = boxAt(Coord(kMaxCoordinate - 1), Coord(2));
  CHECK(maskFromDense(samples.data(), layout)->activeVoxelCount() == 8);
}

TEST_CASE("dense_volume: tells how far it is, and stops when asked to", "[dense_volume]") {
  Array array(boxAt(Coord(0, 0, -3), Coord(5, 4, 20)), SampleType::int32, std::nullopt, 8);
  const auto labels = labelsFromDense(array.first, array.layout);
  const std::vector<int> expected = {0, 15, 55, 95};  // slabs begin at -3, 0, 8 and 16
  const auto check = [&](const auto& run) {
    RecordingStop never(1000), two(2);
    run(never);
    CHECK(never.percents == expected);
    CHECK_THROWS_AS(run(two), Interrupted);
    CHECK(two.percents.size() == 3);
  };
  check([&](Interrupter& i) { maskFromDense(array.first, array.layout, {}, {}, &i); });
  check([&](Interrupter& i) { labelsFromDense(array.first, array.layout, {}, &i); });
  check([&](Interrupter& i) { copyToDense(*labels, array.first, array.layout, &i); });
}
