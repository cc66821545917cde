// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/image_object.h"

#include <cmath>
#include <cstdio>
#include <numeric>
#include <sstream>

#include "support/catch.h"
#include "support/dense_volume.h"
#include "support/files.h"
#include "support/images.h"
#include "support/memory_image.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/images/open_image.h"
#include "vdb_madf/scans/image_box.h"
#include "vdb_madf/scans/mask_cleaning.h"
#include "vdb_madf/scans/scan_region.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

namespace {

/// 0 or 1 a voxel, x fastest.
using Voxels = std::vector<uint8_t>;

Voxels voxelsOf(const MaskGrid& mask, const ImageSize& size) {
  Voxels marks;
  const auto accessor = mask.getConstAccessor();
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) marks.push_back(accessor.isValueOn(Coord(x, y, z)));
  CHECK(std::accumulate(marks.begin(), marks.end(), size_t(0)) == mask.activeVoxelCount());
  return marks;
}

template <typename T>
MaskGrid::Ptr objectOf(const ImageSize& size, const std::vector<T>& samples,
                       const std::optional<Selection>& selection, const GrayOptions& gray = {}) {
  return imageObject([&] { return imageOf(size, samples); }, selection, gray).mask;
}

/// The 6-connected component of each voxel among those of equal value, and the components' sizes.
struct Components {
  std::vector<int> of;
  std::vector<int64_t> sizes;
};

Components componentsOf(const Voxels& voxels, const ImageSize& size) {
  Components found{std::vector<int>(voxels.size(), -1), {}};
  const int steps[] = {1, size.x, size.x * size.y};
  for (size_t start = 0; start < voxels.size(); ++start) {
    if (found.of[start] >= 0) continue;
    const int number = int(found.sizes.size());
    found.sizes.push_back(0);
    std::vector<int> front{int(start)};
    found.of[start] = number;
    while (!front.empty()) {
      const int i = front.back();
      front.pop_back();
      ++found.sizes.back();
      const int at[] = {i % size.x, i / size.x % size.y, i / size.x / size.y};
      for (int axis = 0; axis < 3; ++axis)
        for (const int way : {-1, 1}) {
          if (at[axis] + way < 0 || at[axis] + way >= size[axis]) continue;
          const auto next = size_t(i + way * steps[axis]);
          if (found.of[next] >= 0 || voxels[next] != voxels[start]) continue;
          found.of[next] = number;
          front.push_back(int(next));
        }
    }
  }
  return found;
}

/// Turns the components of a value that are smaller into the other value.
void flipSmall(Voxels& voxels, const ImageSize& size, uint8_t value, int64_t least) {
  const Components components = componentsOf(voxels, size);
  for (size_t i = 0; i < voxels.size(); ++i)
    if (voxels[i] == value && components.sizes[size_t(components.of[i])] < least) voxels[i] ^= 1;
}

const ImageSize kSize{21, 19, 26};

Voxels randomVoxels(int percent, unsigned seed) {
  Voxels marks;
  for (const int number : randomNumbers<int>(voxels(kSize), 0, 99, seed))
    marks.push_back(number < percent);
  return marks;
}

/// The lines that tests/support/gray_reference.py prints.
std::vector<std::string> referenceLines(const std::string& folder) {
  const std::string command = "/usr/bin/python3 -W ignore '" VDB_MADF_TEST_DIR
                              "/support/gray_reference.py' '" +
                              folder + "'";
  FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe);
  std::string text;
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += char(c);
  if (pclose(pipe) == 127 << 8) return {"skipped python3"};
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("image_object: a gray image without a selection is refused with what Otsu would take",
          "[image_object]") {
  auto samples = randomNumbers<uint16_t>(voxels(kSize), 1000, 1400, 1);
  for (size_t i = 0; i < samples.size() / 4; ++i) samples[i] += 3000;
  try {
    objectOf(kSize, samples, std::nullopt);
    FAIL("taken");
  } catch (const SelectionNeeded& error) {
    const std::string what = error.what();
    CHECK_THAT(what, Contains("samples.tif: is a gray image (uint16, values 1000 to 4400;"));
    CHECK_THAT(what, Contains("Otsu's threshold is 2700.5, which takes 25.0 %"));
    CHECK_THAT(what, !Contains("--") && !Contains("closed") && !Contains("\n"));
  }
  // Zeros around a round field of view do not make it a mask.
  for (size_t i = 0; i < samples.size(); i += 3) samples[i] = 0;
  CHECK_THROWS_AS(objectOf(kSize, samples, std::nullopt), SelectionNeeded);
  // Smoothing makes a mask gray.
  GrayOptions smooth;
  smooth.smooth = 1;
  CHECK_THROWS_AS(objectOf(kSize, randomVoxels(30, 2), std::nullopt, smooth), SelectionNeeded);
}

TEST_CASE("image_object: a round field of view does not pass for pores", "[image_object]") {
  const ImageSize size{40, 40, 9};
  std::vector<uint16_t> samples;
  const auto noise = randomNumbers<uint16_t>(voxels(size), 0, 400, 7);
  for (int i = 0; i < int(voxels(size)); ++i) {
    const int x = i % 40 - 20, y = i / 40 % 40 - 20;
    const int value = x * x + y * y > 19 * 19 ? 0 : (x / 5 + y / 5) % 2 ? 4000 : 3000;
    samples.push_back(uint16_t(value + (value > 0 ? noise[size_t(i)] : 0)));
  }
  GrayOptions gray;
  gray.automatic = AutomaticThreshold::otsu;
  CHECK_THROWS_WITH(objectOf(size, samples, std::nullopt, gray),
                    Contains("the threshold would be ") &&
                        Contains("but 3700.5 without the value 0") &&
                        Contains("a cylinder, or choose one of the two by its value"));
  CHECK_THROWS_AS(objectOf(size, samples, std::nullopt, gray), SelectionNeeded);
  CHECK_THROWS_WITH(objectOf(size, samples, std::nullopt),
                    Contains("or 3700.5 without the value 0"));
  // Chosen by value, it is said.
  const auto cornerOf = [&](const ImageSize& part, const GrayOptions& options = {},
                            const std::optional<ScanPart>& region = std::nullopt) {
    return imageObject([&] { return imageOf(part, samples); }, Selection::threshold(3700), options,
                       region)
        .corner;
  };
  GrayOptions hysteresis;
  hysteresis.low = 3000;
  CHECK(cornerOf(size) == 0.0);
  CHECK(cornerOf(size, hysteresis) == 0.0);
  CHECK(cornerOf({40, 40, kCornerSlices}) == 0.0);
  CHECK_FALSE(cornerOf({40, 40, kCornerSlices - 1}));
  // So it is in crops that hold some of it, and not in a region.
  const auto partOf = [](const CoordBBox& box) { return ScanPart{box, Domain(box)}; };
  CHECK(cornerOf(size, {}, partOf({Coord(0, 0, 1), Coord(39, 39, 8)})) == 0.0);
  CHECK_FALSE(cornerOf(size, {}, partOf({Coord(0, 0, 2), Coord(39, 39, 8)})));
  CHECK(cornerOf(size, {}, partOf({Coord(20, 20, 0), Coord(39, 39, 8)})) == 0.0);
  CHECK_FALSE(cornerOf(size, {}, partOf({Coord(10, 10, 0), Coord(29, 29, 8)})));
  const CoordBBox whole(Coord(0), Coord(39, 39, 8));
  CHECK_FALSE(cornerOf(size, {}, ScanPart{whole, cylinderIn(whole, {2, {{20, 20}}, 21})}));
  samples[40 * 40 * 5 + 39] = 1;
  CHECK_FALSE(cornerOf(size));
  samples[40 * 40 * 5 + 39] = 0;
  for (uint16_t& sample : samples) sample = uint16_t(std::max<int>(sample, 3000));
  CHECK_NOTHROW(objectOf(size, samples, std::nullopt, gray));
  // Pores that are as even are no padding, whatever their value is.
  std::vector<float> pores;
  for (size_t i = 0; i < samples.size(); ++i)
    pores.push_back(i % 4 > 0 ? 0.1F : 1 + float(samples[i]) / 1e4F);
  for (size_t z = 0; z < 9; ++z)
    for (const size_t corner : {0, 39, 39 * 40, 39 * 40 + 39}) pores[z * 1600 + corner] = 0.1F;
  CHECK_FALSE(
      imageObject([&] { return imageOf(size, pores); }, Selection::threshold(0.6), {}, std::nullopt)
          .corner);
  // A mask has zeros at its corners, too.
  for (uint16_t& sample : samples) sample = sample > 3700;
  CHECK_NOTHROW(objectOf(size, samples, std::nullopt, gray));
  CHECK_FALSE(cornerOf(size));
}

TEST_CASE("image_object: phases have to be chosen, masks and labels are taken", "[image_object]") {
  CHECK_THROWS_WITH(objectOf(kSize, randomNumbers<uint8_t>(voxels(kSize), 0, 2, 1), std::nullopt),
                    Contains("has the values 0, 1, 2: say which of them are object"));
  const auto mask = randomNumbers<uint8_t>(voxels(kSize), 0, 1, 2);
  CHECK((voxelsOf(*objectOf(kSize, mask, std::nullopt), kSize) == mask));
  std::vector<int32_t> labels;
  for (size_t i = 0; i < voxels(kSize); ++i)
    labels.push_back(int(i) % kSize.x < 7 ? 0 : int(i) % kSize.x / 7 + 2 * (int(i) / 900));
  const auto object = objectOf(kSize, labels, std::nullopt);
  CHECK(object->activeVoxelCount() == voxels(kSize) / 3 * 2);
  CHECK((*object)[kObjectKey] == nullptr);
  CHECK(objectOf<uint8_t>(kSize, Voxels(voxels(kSize), 9), std::nullopt)->activeVoxelCount() ==
        voxels(kSize));
}

TEST_CASE("image_object: hysteresis keeps what is connected with a high voxel", "[image_object]") {
  for (unsigned seed = 1; seed <= 8; ++seed)
    for (const int low : {20, 55, 65, 90}) {
      CAPTURE(seed, low);
      const auto samples = randomNumbers<uint8_t>(voxels(kSize), 0, 99, seed);
      Voxels expected;
      for (const uint8_t value : samples) expected.push_back(value >= low);
      const Components components = componentsOf(expected, kSize);
      std::vector<bool> seeded(components.sizes.size());
      for (size_t i = 0; i < samples.size(); ++i)
        if (samples[i] >= 95) seeded[size_t(components.of[i])] = true;
      for (size_t i = 0; i < samples.size(); ++i)
        expected[i] &= uint8_t(seeded[size_t(components.of[i])]);
      GrayOptions gray;
      gray.low = low;
      Selection high = Selection::threshold(95);
      const auto object = objectOf(kSize, samples, high, gray);
      CHECK((voxelsOf(*object, kSize) == expected));
      CHECK(object->metaValue<double>(kThresholdKey) == 95);
      CHECK(object->metaValue<double>(kThresholdLowKey) == low);
      high.invert = true;
      for (uint8_t& mark : expected) mark ^= 1;
      CHECK((voxelsOf(*objectOf(kSize, samples, high, gray), kSize) == expected));
    }
}

TEST_CASE("image_object: despeckling drops islands, then fills cavities", "[image_object]") {
  for (const int percent : {5, 25, 40, 60, 80, 97})
    for (const int64_t least : {0, 1, 2, 5, 30, 400}) {
      CAPTURE(percent, least);
      const Voxels marks = randomVoxels(percent, unsigned(percent));
      Voxels expected = marks;
      flipSmall(expected, kSize, 1, least);
      const size_t kept = size_t(std::count(expected.begin(), expected.end(), 1));
      const Voxels islandsDropped = expected;
      if (kept > 0) flipSmall(expected, kSize, 0, least);
      if (std::count(expected.begin(), expected.end(), 0) == 0) expected = islandsDropped;
      GrayOptions gray;
      gray.despeckle = least;
      const auto object = objectOf(kSize, marks, std::nullopt, gray);
      CHECK((voxelsOf(*object, kSize) == expected));
      for (auto leaf = object->tree().cbeginLeaf(); leaf; ++leaf) CHECK_FALSE(leaf->isEmpty());
    }
}

TEST_CASE("image_object: despeckling without a domain fills what is enclosed", "[image_object]") {
  const auto mask = MaskGrid::create();
  mask->sparseFill(CoordBBox(Coord(-9), Coord(9)), true);
  mask->tree().setActiveState(Coord(0), false);
  mask->tree().setActiveState(Coord(9, 0, 0), false);  // a dent
  mask->tree().setActiveState(Coord(20), true);
  const Despeckled counts = despeckle(*mask, 8);
  CHECK(counts.islands == 1);
  CHECK(counts.islandVoxels == 1);
  CHECK(counts.cavities == 1);
  CHECK(counts.cavityVoxels == 1);
  CHECK(mask->activeVoxelCount() == 19 * 19 * 19 - 1);
  const auto empty = MaskGrid::create();
  despeckle(*empty, 8);
  CHECK(empty->empty());
}

TEST_CASE("image_object: says how it was made, and only then", "[image_object]") {
  const auto samples = randomNumbers<uint8_t>(voxels(kSize), 0, 99, 3);
  CHECK((*objectOf(kSize, samples, Selection::threshold(50)))[kObjectKey] == nullptr);
  GrayOptions gray;
  gray.median = 1;
  gray.smooth = 0.7;
  gray.automatic = AutomaticThreshold::otsu;
  gray.despeckle = 4;
  Selection inverted;
  inverted.invert = true;
  const auto object = objectOf(kSize, samples, inverted, gray);
  CHECK_THAT(object->metaValue<std::string>(kObjectKey),
             vdb_madf::test::StartsWith("median 1, smooth 0.7, value >= ") &&
                 Contains(" (otsu), inverted, despeckle 4 ("));
  const double threshold = object->metaValue<double>(kThresholdKey);
  // The threshold by hand gives the same object.
  gray.automatic = AutomaticThreshold::none;
  inverted = Selection::threshold(threshold);
  inverted.invert = true;
  CHECK((voxelsOf(*objectOf(kSize, samples, inverted, gray), kSize) == voxelsOf(*object, kSize)));
  CHECK(storedDomain(*object) == imageBox(kSize));
}

TEST_CASE("image_object: counts what is no number, wherever it lies in the domain",
          "[image_object]") {
  const ImageSize size{6, 5, 4};
  const float nan = std::nanf("");
  std::vector<float> samples;
  for (int i = 0; i < 120; ++i) samples.push_back(float(i) / 7);
  for (const int i : {0, 1, 30, 119}) samples[size_t(i)] = nan;  // (0,0,0), (1,0,0), (0,0,1), last
  samples[50] = INFINITY;
  const auto open = [&] { return imageOf(size, samples); };
  const auto nansBy = [&](const Selection& selection, const GrayOptions& gray = {}) {
    return imageObject(open, selection, gray).nans;
  };
  GrayOptions low, smooth;
  low.low = 3;
  smooth.smooth = 0.5;
  CHECK(nansBy(Selection::threshold(5)) == 4);
  CHECK(nansBy(Selection::threshold(5), low) == 4);
  CHECK(nansBy(Selection::threshold(5), smooth) == 4);
  CHECK(nansBy(Selection::range(1, 5)) == 4);
  const Domain slice(CoordBBox(Coord(0, 0, 1), Coord(5, 4, 2)));
  const ImageObject inSlice =
      imageObject(open, Selection::threshold(5), {}, ScanPart{slice.box(), slice});
  CHECK(inSlice.nans == 1);
  CHECK(inSlice.infinities == 1);
  const Domain below(CoordBBox(Coord(0, 0, 0), Coord(5, 4, 0)));
  CHECK(imageObject(open, Selection::threshold(5), {}, ScanPart{below.box(), below}).infinities ==
        0);
}

TEST_CASE("image_object: smoothed values are no phases", "[image_object]") {
  GrayOptions smooth;
  smooth.smooth = 1;
  const std::vector<uint8_t> samples{0, 1, 2, 1};
  CHECK_THROWS_WITH(objectOf<uint8_t>({2, 2, 1}, samples, Selection::phase(1), smooth),
                    Contains("a Gaussian leaves no voxel the value of a phase"));
}

TEST_CASE("image_object: a threshold that is not there is not made up", "[image_object]") {
  GrayOptions gray;
  gray.automatic = AutomaticThreshold::otsu;
  CHECK_THROWS_WITH(objectOf<uint8_t>({2, 2, 1}, {5, 5, 5, 5}, std::nullopt, gray),
                    Contains("samples.tif: has but one value"));
  gray.automatic = AutomaticThreshold::valley;
  CHECK_THROWS_AS(objectOf<uint8_t>({2, 2, 1}, {5, 5, 5, 6}, std::nullopt, gray), SelectionNeeded);
}

TEST_CASE("image_object: equals SciPy and scikit-image", "[image_object]") {
  const ScratchFolder folder;
  int compared = 0;
  for (const std::string& line : referenceLines(folder.path())) {
    CAPTURE(line);
    std::istringstream words(line);
    std::string volume, result, method;
    double first = 0, second = 0;
    words >> volume >> result >> method >> first >> second;
    if (volume == "skipped") {
      WARN("SKIPPED: the comparison with SciPy and scikit-image: Python's " << result
                                                                            << " is not installed");
      return;
    }
    const auto open = [&] { return openImage(folder / volume); };
    const auto expected = openImage(folder / result);
    const ImageSize size = expected->info().size;
    const std::string bytes = readAll(*expected);
    GrayOptions gray;
    Selection selection = Selection::threshold(first);
    if (method == "median" || method == "smooth") {
      if (method == "median") gray.median = int(first);
      if (method == "smooth") gray.smooth = first;
      const auto filtered = filteredImage(open(), gray);
      REQUIRE(filtered->info().type == expected->info().type);
      const std::string found = readAll(*filtered, 8);
      bool same = found == bytes;
      if (!same && filtered->info().type == SampleType::float32) {
        // Another exponential or another order of sums is worth a bit of a sum in double precision.
        same = true;
        for (size_t i = 0; i < bytes.size(); i += 4) {
          float a, b;
          std::memcpy(&a, &bytes[i], 4);
          std::memcpy(&b, &found[i], 4);
          same &= std::abs(a - b) <= 2e-7F * std::abs(a);
        }
      }
      CHECK(same);
    } else {
      if (method == "otsu") gray.automatic = AutomaticThreshold::otsu;
      if (method == "valley") gray.automatic = AutomaticThreshold::valley;
      if (method == "despeckle") gray.despeckle = int64_t(second);
      if (method == "hysteresis") {
        gray.low = first;
        selection = Selection::threshold(second);
      }
      const Voxels found = voxelsOf(*imageObject(open, selection, gray).mask, size);
      CHECK((std::string(found.begin(), found.end()) == bytes));
    }
    ++compared;
  }
  CHECK(compared >= 30);
}
