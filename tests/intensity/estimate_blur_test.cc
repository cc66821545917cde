// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/estimate_blur.h"

#include <cmath>
#include <random>

#include "support/catch.h"
#include "support/memory_image.h"
#include "vdb_madf/scans/filtered_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

constexpr int kSide = 90, kWall = 38;

double fromAxis(const Coord& p) {
  return std::hypot(p.x() - (kSide - 1) / 2.0, p.y() - (kSide - 1) / 2.0);
}

/// Balls of 2000 (every other of `other`) on 1000, through a blur of 1 and noise; around them a
/// container of that value.
GrayScan scan(float container, float other = 2000) {
  std::vector<float> values(size_t(kSide * kSide * kSide), 1000);
  size_t i = 0;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x, ++i) {
        const int cell = 30;
        const Coord p(x, y, z);
        const Coord from(x % cell - cell / 2, y % cell - cell / 2, z % cell - cell / 2);
        if (from.asVec3i().lengthSqr() <= 121)
          values[i] = (x / cell + y / cell + z / cell) % 2 ? other : 2000;
        if (fromAxis(p) > kWall) values[i] = container;
      }
  const ImageSize size{kSide, kSide, kSide};
  auto blurred = smoothedImage(std::make_unique<SamplesImage<float>>(size, std::move(values)), 1);
  std::vector<float> noisy(size_t(kSide * kSide * kSide));
  blurred->read(0, kSide, noisy.data());
  std::mt19937 random(1);
  std::normal_distribution<float> noise(0, 40);
  for (float& value : noisy) value += noise(random);
  return {std::make_unique<SamplesImage<float>>(size, std::move(noisy)), Coord(0)};
}

/// Of voxels that the blurred container does not reach.
Domain withinWall() {
  MaskTree region;
  for (auto p = CoordBBox(Coord(0), Coord(kSide - 1)).begin(); p; ++p)
    if (fromAxis(*p) <= kWall - 6) region.setValueOn(*p);
  return Domain(region);
}

}  // namespace

TEST_CASE("estimate_blur: what is around the labels' region does not count", "[estimate_blur]") {
  const auto empty = estimateBlur(scan(1000), withinWall());
  REQUIRE(empty);
  CHECK(empty->sigma == Approx(1.05).epsilon(0.1));  // with the voxel itself
  CHECK(empty->noise == Approx(0.04).epsilon(0.1));
  CHECK(empty->inside == Approx(2000).epsilon(0.01));
  for (const float container : {0.0F, 1500.0F, 9000.0F}) {
    CAPTURE(container);
    const auto blur = estimateBlur(scan(container), withinWall());
    REQUIRE(blur);
    CHECK(blur->sigma == empty->sigma);
    CHECK(blur->noise == empty->noise);
    CHECK(blur->inside == empty->inside);
  }
  const auto whole = estimateBlur(scan(9000), std::nullopt);
  CHECK((!whole || whole->inside > 5000));  // it was the container's
}

TEST_CASE("estimate_blur: of a crop, and of all that a scan has", "[estimate_blur]") {
  const CoordBBox crop(Coord(20, 21, 5), Coord(69, 68, 84));
  const auto cropped = estimateBlur(scan(0), Domain(crop));
  REQUIRE(cropped);
  CHECK(cropped->sigma == Approx(1.05).epsilon(0.15));
  const CoordBBox all(Coord(0), Coord(kSide - 1));
  CHECK(estimateBlur(scan(1000), Domain(all))->sigma == estimateBlur(*scan(1000).image)->sigma);
  CHECK_THROWS_AS(estimateBlur(scan(0), Domain(CoordBBox(Coord(50), Coord(99)))), InvalidInput);
}

TEST_CASE("estimate_blur: a note tells of a third material", "[estimate_blur]") {
  CHECK(noteOn(*estimateBlur(scan(1000), withinWall())) == "");
  CHECK_THAT(noteOn(*estimateBlur(scan(1000, 3000), withinWall())), Contains("spread"));
}
