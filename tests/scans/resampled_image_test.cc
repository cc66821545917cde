// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/resampled_image.h"

#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "support/memory_image.h"
#include "vdb_madf/base/errors.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

template <typename T>
std::vector<T> readAll(ImageReader& image, int slices) {
  const ImageSize& size = image.info().size;
  std::vector<T> samples(size_t(size.x) * size_t(size.y) * size_t(size.z));
  for (int z = 0; z < size.z; z += slices)
    image.read(z, std::min(slices, size.z - z),
               &samples[size_t(z) * size_t(size.x) * size_t(size.y)]);
  return samples;
}

/// Linear between the centers of voxels, the outermost value beyond; all in tenths of a micrometer.
template <typename T>
double interpolated(const std::vector<T>& samples, const ImageSize& size, const int (&voxel)[3],
                    int cube, const int (&place)[3]) {
  int lower[3];
  double beyond[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double at =
        std::clamp((place[axis] + 0.5) * cube / voxel[axis] - 0.5, 0.0, double(size[axis] - 1));
    lower[axis] = std::min(int(at), std::max(0, size[axis] - 2));
    beyond[axis] = at - lower[axis];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    int at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = corner >> axis & 1;
      weight *= upper ? beyond[axis] : 1 - beyond[axis];
      at[axis] = std::min(lower[axis] + upper, size[axis] - 1);
    }
    sum += weight * double(samples[size_t((at[2] * size.y + at[1]) * size.x + at[0])]);
  }
  return sum;
}

template <typename T>
void checkType() {
  std::mt19937 random(7);
  const auto upTo = [&](int most) { return 1 + int(random() % unsigned(most)); };
  for (unsigned seed = 0; seed < 25; ++seed) {
    const ImageSize size{upTo(9), upTo(9), upTo(9)};
    const int voxel[3] = {upTo(9), upTo(9), upTo(9)}, cube = upTo(8);
    const auto samples = randomNumbers<T>(size_t(size.x) * size_t(size.y) * size_t(size.z),
                                          std::is_signed_v<T> ? -90 : 0, 120, seed);
    const VoxelSize voxels({voxel[0] * 1e-7, voxel[1] * 1e-7, voxel[2] * 1e-7});
    int count[3];
    for (int axis = 0; axis < 3; ++axis)
      count[axis] = (2 * size[axis] * voxel[axis] + cube) / (2 * cube);
    if (std::min({count[0], count[1], count[2]}) == 0) {
      CHECK_THROWS_AS(resampledImage(imageOf(size, samples), voxels, cube * 1e-7), InvalidInput);
      continue;
    }
    const auto image = resampledImage(imageOf(size, samples), voxels, cube * 1e-7);
    REQUIRE(image->info().size == ImageSize{count[0], count[1], count[2]});
    REQUIRE(image->info().type == typeOf<T>());
    REQUIRE(image->info().voxelSize->edges() == VoxelSize(cube * 1e-7).edges());
    const auto cubes = readAll<T>(*image, 3);
    REQUIRE(cubes == readAll<T>(*resampledImage(imageOf(size, samples), voxels, cube * 1e-7), 8));
    size_t n = 0;
    for (int z = 0; z < count[2]; ++z)
      for (int y = 0; y < count[1]; ++y)
        for (int x = 0; x < count[0]; ++x, ++n) {
          const double expected = interpolated(samples, size, voxel, cube, {x, y, z});
          if constexpr (std::is_integral_v<T>)  // half a unit is as near to either side
            REQUIRE(std::abs(double(cubes[n]) - expected) <= 0.5 + 1e-9);
          else
            REQUIRE(double(cubes[n]) == Approx(expected).margin(1e-4));
        }
  }
}

}  // namespace

TEST_CASE("resampled_image: values are linear between the centers of voxels", "[resampled_image]") {
  checkType<uint8_t>();
  checkType<int16_t>();
  checkType<uint32_t>();
  checkType<float>();
  checkType<double>();
}

TEST_CASE("resampled_image: a line by hand", "[resampled_image]") {
  const auto line = [](const std::vector<uint8_t>& samples, double voxel, double cube) {
    const auto image = resampledImage(imageOf<uint8_t>({int(samples.size()), 1, 1}, samples),
                                      VoxelSize({voxel, cube, cube}), cube);
    return readAll<uint8_t>(*image, 8);
  };
  using Line = std::vector<uint8_t>;
  CHECK(line({10, 20, 40}, 2, 2) == Line{10, 20, 40});
  CHECK(line({10, 20, 40}, 2, 1) == Line{10, 13, 18, 25, 35, 40});  // 12.5 and 17.5 are rounded up
  CHECK(line({10, 20, 40, 60}, 1, 2) == Line{15, 50});
  CHECK(line({10, 20, 40, 60}, 1, 3) == Line{20});
  CHECK(line({10, 20, 40, 60, 99}, 1, 2) == Line{15, 50, 99});  // half a cube is one
  const std::array<double, 3> origin = resampledOrigin(VoxelSize({1e-6, 2e-6, 4e-6}), 2e-6);
  CHECK(origin[0] == Approx(0.5e-3));
  CHECK(origin[1] == 0);
  CHECK(origin[2] == Approx(-1e-3));
}

TEST_CASE("resampled_image: values that are not finite stay where they are", "[resampled_image]") {
  const float nan = std::nanf(""), infinite = INFINITY;
  const auto image = resampledImage(imageOf<float>({4, 1, 1}, {1, nan, 3, infinite}),
                                    VoxelSize({1e-6, 1e-6, 1e-6}), 1e-6);
  const auto same = readAll<float>(*image, 1);
  CHECK(same[0] == 1);
  CHECK(std::isnan(same[1]));
  CHECK(same[2] == 3);
  CHECK(same[3] == infinite);
}

TEST_CASE("resampled_image: what makes no sense is refused", "[resampled_image]") {
  const auto image = [] {
    return imageOf<uint8_t>({2000, 2000, 1}, std::vector<uint8_t>(4000000));
  };
  const VoxelSize voxels({1e-6, 1e-6, 200e-6});
  CHECK_THROWS_WITH(resampledImage(image(), voxels, 300e-6), vdb_madf::test::Contains("256 times"));
  CHECK_THROWS_WITH(resampledImage(image(), VoxelSize(1e-6), 10e-6),
                    vdb_madf::test::Contains("half as thick"));
  CHECK_THROWS_WITH(resampledImage(image(), VoxelSize(1e-6), 0.05e-6),
                    vdb_madf::test::Contains("26754 voxels long"));
  CHECK_THROWS_WITH(resampledImage(image(), VoxelSize({1e-6, 1e-6, 20e-6}), 0.08e-6),
                    vdb_madf::test::Contains("4294966784 voxels"));
}
