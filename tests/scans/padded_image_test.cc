// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/padded_image.h"

#include <algorithm>
#include <string>

#include "support/catch.h"
#include "support/images.h"
#include "support/memory_image.h"
#include "vdb_madf/grids/object_keys.h"
#include "vdb_madf/scans/image_object.h"
#include "vdb_madf/scans/scan_region.h"

using namespace vdb_madf;
using namespace vdb_madf::test;
using vdb_madf::test::Contains;

TEST_CASE("padded_image: padding moves no threshold, filtered, cropped or in a region",
          "[padded_image]") {
  const ImageSize size{64, 64, 12};
  std::vector<uint16_t> samples;
  const auto noise = randomNumbers<uint16_t>(voxels(size), 0, 400, 7);
  for (int i = 0; i < int(voxels(size)); ++i) {
    const int x = i % 64 - 32, y = i / 64 % 64 - 32;
    const int value = (x / 5 + y / 5) % 2 ? 4000 : 3000;
    samples.push_back(uint16_t(x * x + y * y > 26 * 26 ? 0 : value + noise[size_t(i)]));
  }
  const auto open = [&] { return imageOf(size, samples); };
  const CoordBBox whole(Coord(0), Coord(63, 63, 11));
  const auto cylinder = [&](double radius) {
    return ScanPart{whole, cylinderIn(whole, {2, {{32, 32}}, radius})};
  };
  const CoordBBox low(Coord(0, 0, 2), Coord(63, 63, 9)), off(Coord(30, 4, 0), Coord(63, 63, 11));
  using Step = std::pair<int, double>;
  for (const auto& [median, smooth] : {Step{0, 0}, Step{1, 0}, Step{0, 0.7}, Step{1, 0.5}})
    for (const auto method : {AutomaticThreshold::otsu, AutomaticThreshold::valley}) {
      CAPTURE(median, smooth, int(method));
      GrayOptions gray;
      gray.median = median;
      gray.smooth = smooth;
      gray.automatic = method;
      // What filters mix with nothing outside of the core.
      const int reach = median + int(4 * smooth + 0.5);
      const auto core = imageObject(open, std::nullopt, gray, cylinder(26 - 1.5 * reach)).mask;
      const auto right = core->metaValue<double>(kThresholdKey);
      for (const std::optional<ScanPart>& part :
           {std::optional<ScanPart>(), std::optional(ScanPart{low, Domain(low)}),
            std::optional(ScanPart{off, Domain(off)}), std::optional(cylinder(30))}) {
        std::string said;
        try {
          imageObject(open, std::nullopt, gray, part);
        } catch (const SelectionNeeded& error) {
          said = error.what();
          CHECK(error.orCylinder() == (!part || part->domain.isBox()));
        }
        REQUIRE_THAT(said, Contains(" without the value 0") && Contains(", but "));
        CHECK(std::stod(said.substr(said.find("but ") + 4)) == Approx(right).epsilon(0.05));
      }
      CHECK_NOTHROW(imageObject(open, std::nullopt, gray, cylinder(26)));
      const CoordBBox within(Coord(14, 14, 0), Coord(50, 50, 11));
      CHECK_NOTHROW(imageObject(open, std::nullopt, gray, ScanPart{within, Domain(within)}));
    }
}

TEST_CASE("padded_image: a saturated scan is not taken for a round one", "[padded_image]") {
  const ImageSize size{40, 40, 9};
  std::vector<uint8_t> samples;
  const auto noise = randomNumbers<uint8_t>(voxels(size), 0, 80, 3);
  for (int i = 0; i < int(voxels(size)); ++i) {
    const int x = i % 40, y = i / 40 % 40;
    const int value = (x / 5 + y / 5) % 2 ? 190 : 0;
    samples.push_back(uint8_t(std::max(value + noise[size_t(i)] - 40, 0)));
    if ((x == 0 || x == 39) && (y == 0 || y == 39)) samples.back() = 0;
  }
  const auto open = [&] { return imageOf(size, samples); };
  GrayOptions gray;
  gray.automatic = AutomaticThreshold::otsu;
  CHECK_NOTHROW(imageObject(open, std::nullopt, gray));
  gray.median = 1;
  CHECK_NOTHROW(imageObject(open, std::nullopt, gray));
}
