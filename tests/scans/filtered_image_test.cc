// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "support/catch.h"
#include "support/images.h"
#include "support/memory_image.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/scans/filtered_image.h"

using namespace vdb_madf;
using namespace vdb_madf::test;

namespace {

/// Reflected at a face as often as it takes.
int reflected(int i, int size) {
  while (i < 0 || i >= size) i = i < 0 ? -1 - i : 2 * size - 1 - i;
  return i;
}

template <typename T>
T at(const std::vector<T>& samples, const ImageSize& size, int x, int y, int z) {
  const size_t row = size_t(reflected(z, size.z)) * size_t(size.y) + size_t(reflected(y, size.y));
  return samples[row * size_t(size.x) + size_t(reflected(x, size.x))];
}

template <typename T>
bool isNan(T value) {
  return value != value;
}

template <typename T>
std::vector<T> medianByDefinition(const std::vector<T>& samples, const ImageSize& size, int r) {
  std::vector<T> medians;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        std::vector<T> cube;
        for (int k = -r; k <= r; ++k)
          for (int j = -r; j <= r; ++j)
            for (int i = -r; i <= r; ++i) cube.push_back(at(samples, size, x + i, y + j, z + k));
        const T here = at(samples, size, x, y, z);
        cube.erase(std::remove_if(cube.begin(), cube.end(), isNan<T>), cube.end());
        std::sort(cube.begin(), cube.end());
        medians.push_back(isNan(here) ? here : cube[(cube.size() - 1) / 2]);
      }
  return medians;
}

/// The product of three one-dimensional kernels, all in double precision.
template <typename T>
std::vector<double> gaussianByDefinition(const std::vector<T>& samples, const ImageSize& size,
                                         double sigma) {
  const int r = int(4 * sigma + 0.5);
  std::vector<double> weights;
  for (int i = -r; i <= r; ++i) weights.push_back(std::exp(-i * i / (2 * sigma * sigma)));
  std::vector<double> smooth;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        double value = 0, sum = 0;
        for (int k = -r; k <= r; ++k)
          for (int j = -r; j <= r; ++j)
            for (int i = -r; i <= r; ++i) {
              const auto there = double(at(samples, size, x + i, y + j, z + k));
              if (isNan(there)) continue;
              const double weight =
                  weights[size_t(i + r)] * weights[size_t(j + r)] * weights[size_t(k + r)];
              value += weight * there;
              sum += weight;
            }
        smooth.push_back(isNan(at(samples, size, x, y, z)) ? NAN : value / sum);
      }
  return smooth;
}

template <typename T>
std::vector<T> valuesOf(ImageReader& image, int step) {
  const std::string bytes = readAll(image, step);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

const ImageSize kSizes[] = {{1, 1, 1}, {5, 4, 3}, {2, 9, 17}, {70, 3, 2}, {1, 1, 30}, {9, 8, 11}};

template <typename T>
void checkMedian(int low, int high) {
  unsigned seed = 1;
  for (const ImageSize& size : kSizes)
    for (int radius = 1; radius <= kMaxMedianRadius; ++radius) {
      CAPTURE(size.x, size.y, size.z, radius);
      const auto samples = randomNumbers<T>(voxels(size), low, high, ++seed);
      const auto expected = medianByDefinition(samples, size, radius);
      constexpr std::array<int, 3> kSteps{1, 8, 100};
      const auto image = medianImage(imageOf(size, samples), radius);
      CHECK(image->info().type == typeOf<T>());
      const bool same = valuesOf<T>(*image, kSteps.at(seed % kSteps.size())) == expected;
      CHECK(same);
    }
}

template <typename T, typename Result>
void checkSmoothing(double tolerance) {
  unsigned seed = 1;
  for (const ImageSize& size : kSizes)
    for (const double sigma : {0.1, 0.4, 1.3}) {
      CAPTURE(size.x, size.y, size.z, sigma);
      const auto samples = randomNumbers<T>(voxels(size), 0, 120, ++seed);
      const auto expected = gaussianByDefinition(samples, size, sigma);
      const auto image = smoothedImage(imageOf(size, samples), sigma);
      CHECK(image->info().type == typeOf<Result>());
      const auto found = valuesOf<Result>(*image, 8);
      double error = 0;
      for (size_t i = 0; i < found.size(); ++i)
        error = std::max(error, std::abs(double(found[i]) - expected[i]));
      CHECK(error <= 120 * tolerance);
      const bool same = valuesOf<Result>(*smoothedImage(imageOf(size, samples), sigma), 1) == found;
      CHECK(same);
    }
}

}  // namespace

TEST_CASE("filtered_image: the median is that of the cube", "[filtered_image]") {
  checkMedian<uint8_t>(0, 255);
  checkMedian<int16_t>(-30, 30);
  checkMedian<uint16_t>(0, 65535);
  checkMedian<int32_t>(-9, 9);
  checkMedian<float>(-5, 5);
}

TEST_CASE("filtered_image: the Gaussian is the convolution", "[filtered_image]") {
  checkSmoothing<uint8_t, float>(3e-7);
  checkSmoothing<uint16_t, float>(3e-7);
  checkSmoothing<float, float>(3e-7);
  checkSmoothing<int32_t, double>(1e-13);
  checkSmoothing<double, double>(1e-13);
}

TEST_CASE("filtered_image: what is no number takes nothing with it", "[filtered_image]") {
  unsigned seed = 50;
  for (const ImageSize& size : kSizes) {
    CAPTURE(size.x, size.y, size.z);
    auto samples = randomNumbers<float>(voxels(size), 0, 120, ++seed);
    std::mt19937 random(seed);
    for (float& sample : samples)
      if (random() % 12 == 0) sample = NAN;
    const auto median = medianByDefinition(samples, size, 1);
    const auto smooth = gaussianByDefinition(samples, size, 0.7);
    for (const int step : {1, 8, 100}) {
      const auto medians = valuesOf<float>(*medianImage(imageOf(size, samples), 1), step);
      const auto means = valuesOf<float>(*smoothedImage(imageOf(size, samples), 0.7), step);
      size_t wrong = 0;
      for (size_t i = 0; i < samples.size(); ++i) {
        wrong += isNan(median[i]) ? !isNan(medians[i]) : medians[i] != median[i];
        wrong +=
            isNan(smooth[i]) ? !isNan(means[i]) : !(std::abs(double(means[i]) - smooth[i]) <= 5e-5);
      }
      CHECK(wrong == 0);
    }
    // Far from NaN the bits are those without.
    if (size.z < 30) continue;
    auto whole = randomNumbers<float>(voxels(size), 0, 120, seed);
    const auto expected = valuesOf<float>(*smoothedImage(imageOf(size, whole), 0.7), 100);
    whole[3] = NAN;
    const auto found = valuesOf<float>(*smoothedImage(imageOf(size, whole), 0.7), 100);
    CHECK(std::equal(found.begin() + 7, found.end(), expected.begin() + 7));
  }
}

TEST_CASE("filtered_image: a filter reads a slice once, and no more at a time than asked for",
          "[filtered_image]") {
  class Counting : public SamplesImage<uint8_t> {
   public:
    Counting() : SamplesImage<uint8_t>({4, 4, 40}, std::vector<uint8_t>(640, 3)) {}
    void read(int first, int count, void* to) override {
      CHECK(first == next);
      next = first + count;
      SamplesImage<uint8_t>::read(first, count, to);
    }
    int next = 0;
  };
  auto source = std::make_unique<Counting>();
  const Counting& counting = *source;
  const auto image = smoothedImage(medianImage(std::move(source), 2), 1);
  std::vector<float> slab(16 * 8);
  for (int z = 0; z < 40; z += 8) {
    image->read(z, 8, slab.data());
    CHECK(counting.next == std::min(40, z + 8 + 4 + 2));  // as far as both filters reach
    CHECK(slab == std::vector<float>(slab.size(), 3.0F));
  }
}

TEST_CASE("filtered_image: what cannot be done is said", "[filtered_image]") {
  const auto image = [] { return imageOf<uint8_t>({1, 1, 1}, {5}); };
  CHECK_THROWS_AS(medianImage(image(), 0), InvalidInput);
  CHECK_THROWS_AS(medianImage(image(), 4), InvalidInput);
  CHECK_THROWS_AS(smoothedImage(image(), 0), InvalidInput);
  CHECK_THROWS_AS(smoothedImage(image(), 20.5), InvalidInput);
  CHECK_THROWS_AS(smoothedImage(image(), std::nan("")), InvalidInput);
}
