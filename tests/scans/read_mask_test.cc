// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>
#include <limits>

#include "support/catch.h"
#include "support/images.h"
#include "support/runs.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_mask.h"
#include "vdb_madf/images/image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/read_mask.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// An image in memory.
class MemoryImage : public ImageReader {
 public:
  MemoryImage(const Coord& size, SampleType type, std::string bytes) : bytes_(std::move(bytes)) {
    info_.size = toImageSize(size);
    info_.type = type;
    path_ = "some/folder/memory.tif";
  }
  void setPath(const std::string& path) { path_ = path; }
  void setVoxelSize(double metres) { info_.voxelSize = VoxelSize{metres}; }
  void read(int first, int count, void* samples) override {
    const size_t slice = bytes_.size() / size_t(info_.size.z);
    std::memcpy(samples, bytes_.data() + slice * size_t(first), slice * size_t(count));
    ++reads;
    mostSlices = std::max(mostSlices, count);
  }
  double value(size_t i) const {
    const char* place = bytes_.data() + i * sampleSize(info_.type);
    switch (info_.type) {
      case SampleType::uint8:
        return as<uint8_t>(place);
      case SampleType::int8:
        return as<int8_t>(place);
      case SampleType::uint16:
        return as<uint16_t>(place);
      case SampleType::int16:
        return as<int16_t>(place);
      case SampleType::uint32:
        return as<uint32_t>(place);
      case SampleType::int32:
        return as<int32_t>(place);
      case SampleType::float32:
        return double(as<float>(place));
      case SampleType::float64:
        return as<double>(place);
    }
    return 0;
  }
  int reads = 0, mostSlices = 0;

 private:
  template <typename T>
  static T as(const char* place) {
    T value;
    std::memcpy(&value, place, sizeof value);
    return value;
  }
  std::string bytes_;
};

/// Puts the numbers that are hard for comparisons among the samples of a float image.
template <typename T>
void addSpecialValues(std::string& bytes) {
  using Limits = std::numeric_limits<T>;
  const T special[] = {Limits::quiet_NaN(),
                       -Limits::quiet_NaN(),
                       Limits::infinity(),
                       -Limits::infinity(),
                       T(-0.0),
                       Limits::denorm_min(),
                       Limits::max(),
                       Limits::lowest(),
                       std::nextafter(T(1), T(2)),
                       std::nextafter(T(1), T(0)),
                       T(0.1),
                       T(0.3)};
  size_t next = 0;
  for (size_t i = 0; i + sizeof(T) <= bytes.size(); i += 3 * sizeof(T))
    std::memcpy(&bytes[i], &special[next++ % std::size(special)], sizeof(T));
}

std::vector<Selection> selections() {
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<Selection> all = {
      {},
      Selection::phase(1),
      Selection::phase(2),
      Selection::phase(0),
      Selection::phase(-1),
      Selection::phase(0.5),
      Selection::phase(255),
      Selection::phase(256),
      Selection::phase(4294967295.0),
      Selection::phase(std::nan("")),
      Selection::phase(0.1),
      Selection::phase(double(0.1F)),
      Selection::threshold(0),
      Selection::threshold(1),
      Selection::threshold(0.1),
      Selection::threshold(127.5),
      Selection::threshold(-129),
      Selection::threshold(65535),
      Selection::threshold(1e300),
      Selection::threshold(-1e300),
      Selection::threshold(infinity),
      Selection::threshold(-infinity),
      Selection::threshold(std::nan("")),
      Selection::range(1, 2),
      Selection::range(2, 1),
      Selection::range(1.1, 1.9),
      Selection::range(-5.5, 100.25),
      Selection::range(-infinity, 0),
      Selection::range(-1e300, 1e300),
      Selection::range(0.1, 0.3),
      Selection::range(1e300, infinity),
      Selection::range(-infinity, -1e300),
      Selection::range(-300, -200),
      Selection::range(70000, 80000),
      Selection::range(0, std::nan("")),
      Selection::phases({1, 3}),
      Selection::phases({2, 0, -1, 0.5, 255, 70000}),
      Selection::phases({std::nan(""), 0.1, double(0.1F), infinity}),
  };
  const size_t count = all.size();
  for (size_t i = 0; i < count; ++i) {
    all.push_back(all[i]);
    all.back().invert = true;
  }
  return all;
}

/// Compares with the selection's own word, voxel by voxel; returns the first that differs.
std::optional<Coord> firstDifference(const MaskGrid& mask, const MemoryImage& image,
                                     const Selection& selection) {
  const auto accessor = mask.getConstAccessor();
  const bool areFloats = image.info().type == SampleType::float32;
  const Selection meant = areFloats ? selection.ofFloats() : selection;
  const Coord size = toCoord(image.info().size);
  size_t i = 0, active = 0;
  for (int z = 0; z < size.z(); ++z)
    for (int y = 0; y < size.y(); ++y)
      for (int x = 0; x < size.x(); ++x, ++i) {
        const bool expected = meant(image.value(i));
        active += expected;
        if (accessor.isValueOn(Coord(x, y, z)) != expected) return Coord(x, y, z);
      }
  if (mask.activeVoxelCount() != active) return Coord(-1);  // something outside of the image
  return std::nullopt;
}

bool hasOnlyLeavesWithObject(const MaskGrid& mask) {
  for (auto leaf = mask.tree().cbeginLeaf(); leaf; ++leaf)
    if (leaf->isEmpty()) return false;
  return mask.tree().activeTileCount() == 0;
}

}  // namespace

TEST_CASE("image_mask: equals the selection asked voxel by voxel", "[image_mask]") {
  unsigned seed = 1;
  for (const Coord& size : {Coord(1), Coord(7, 8, 9), Coord(8), Coord(9, 1, 17), Coord(17, 16, 1),
                            Coord(33, 7, 8), Coord(64, 9, 3), Coord(1, 25, 2)})
    for (const SampleType type : kSampleTypes) {
      std::string bytes = randomSamples(type, voxels(toImageSize(size)), ++seed);
      if (type == SampleType::float32) addSpecialValues<float>(bytes);
      if (type == SampleType::float64) addSpecialValues<double>(bytes);
      MemoryImage image(size, type, bytes);
      for (const Selection& selection : selections()) {
        CAPTURE(seed, size, sampleTypeName(type), int(selection.kind), selection.low,
                selection.high, selection.invert);
        const auto mask = readMask(image, selection);
        const auto difference = firstDifference(*mask, image, selection);
        CAPTURE(difference.value_or(Coord(0)));
        REQUIRE_FALSE(difference);
        REQUIRE(hasOnlyLeavesWithObject(*mask));
      }
      CHECK(image.mostSlices <= 8);
    }
}

TEST_CASE("image_mask: the comparison notices a wrong voxel", "[image_mask]") {
  MemoryImage image(Coord(9), SampleType::uint8, randomSamples(SampleType::uint8, 729, 5));
  const auto mask = readMask(image);
  const bool was = mask->tree().isValueOn(Coord(8, 8, 8));
  mask->tree().setActiveState(Coord(8, 8, 8), !was);
  CHECK(firstDifference(*mask, image, {}));
}

TEST_CASE("image_mask: a large slice is packed in parallel chunks alike", "[image_mask]") {
  const Coord size(700, 301, 9);
  MemoryImage image(size, SampleType::uint16,
                    randomSamples(SampleType::uint16, voxels(toImageSize(size)), 77));
  CHECK_FALSE(firstDifference(*readMask(image, Selection::phase(1)), image, Selection::phase(1)));
}

TEST_CASE("image_mask: says where it comes from", "[image_mask]") {
  MemoryImage image(Coord(5, 6, 7), SampleType::uint8, std::string(210, '\0'));
  auto mask = readMask(image);
  CHECK(mask->empty());
  CHECK(mask->getName() == "object");
  CHECK(storedDomain(*mask) == CoordBBox(Coord(0), Coord(4, 5, 6)));
  CHECK_FALSE(storedVoxelSize(*mask));
  CHECK(mask->voxelSize()[0] == 1.0);
  CHECK(mask->metaValue<std::string>("madf_source") == "memory.tif");
  image.setVoxelSize(8.5e-6);
  image.setPath("/scans/sample7/");
  mask = readMask(image);
  CHECK(storedVoxelSize(*mask)->edge() == 8.5e-6);
  CHECK(mask->voxelSize()[0] == Approx(0.0085));
  CHECK(mask->metaValue<std::string>("madf_source") == "sample7");
}

TEST_CASE("image_mask: stops when asked to", "[image_mask]") {
  MemoryImage image(Coord(8, 8, 80), SampleType::uint8, std::string(8 * 8 * 80, 'a'));
  StopAfter three(3), never(1000);
  CHECK_THROWS_AS(readMask(image, {}, &three), Interrupted);
  CHECK(image.reads == 3);
  CHECK(readMask(image, {}, &never)->activeVoxelCount() == 8 * 8 * 80);
}

// What NumPy says of a float32 array and these numbers.
TEST_CASE("read_mask: decimals of float32 are those nearest to them", "[read_mask]") {
  const float values[] = {0.1F, 0.3F, 0.5F, 0.7F, std::nextafter(0.7F, 0.0F)};
  MemoryImage image(Coord(5, 1, 1), SampleType::float32,
                    std::string(reinterpret_cast<const char*>(values), sizeof values));
  const auto count = [&](const Selection& selection) {
    return readMask(image, selection)->activeVoxelCount();
  };
  CHECK(count(Selection::threshold(0.7)) == 1);
  CHECK(count(Selection::phase(0.7)) == 1);
  CHECK(count(Selection::phases({0.1, 0.7})) == 2);
  CHECK(count(Selection::range(0.05, 0.1)) == 1);
  CHECK(count(Selection::range(0.3, 0.7)) == 4);
  const auto grid = FloatGrid::create(0);
  for (int x = 0; x < 5; ++x) grid->tree().setValueOn(Coord(x, 0, 0), values[x]);
  CHECK(objectMask(*grid, Selection::threshold(0.7))->activeVoxelCount() == 1);
  CHECK(objectMask(*grid, Selection::phases({0.1, 0.7}))->activeVoxelCount() == 2);
}
