// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <type_traits>
#include <vector>

#include "vdb_madf/images/image.h"

namespace vdb_madf::test {

template <typename T>
constexpr SampleType typeOf() {
  if constexpr (std::is_same_v<T, float>) return SampleType::float32;
  if constexpr (std::is_same_v<T, double>) return SampleType::float64;
  constexpr bool negative = std::is_signed_v<T>;
  switch (sizeof(T)) {
    case 1:
      return negative ? SampleType::int8 : SampleType::uint8;
    case 2:
      return negative ? SampleType::int16 : SampleType::uint16;
    default:
      return negative ? SampleType::int32 : SampleType::uint32;
  }
}

/// Samples in memory as an image, x fastest.
template <typename T>
class SamplesImage : public ImageReader {
 public:
  SamplesImage(const ImageSize& size, std::vector<T> samples) : samples_(std::move(samples)) {
    info_.size = size;
    info_.type = typeOf<T>();
    path_ = "samples.tif";
  }
  void read(int first, int count, void* to) override {
    const size_t slice = size_t(info_.size.x) * size_t(info_.size.y);
    std::memcpy(to, samples_.data() + slice * size_t(first), slice * size_t(count) * sizeof(T));
    mostSlices = std::max(mostSlices, count);
  }
  int mostSlices = 0;

 private:
  std::vector<T> samples_;
};

template <typename T>
std::unique_ptr<ImageReader> imageOf(const ImageSize& size, const std::vector<T>& samples) {
  return std::make_unique<SamplesImage<T>>(size, samples);
}

/// Whole numbers from `low` to `high`.
template <typename T>
std::vector<T> randomNumbers(size_t count, int low, int high, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<T> numbers(count);
  for (T& number : numbers) number = T(low + int(random() % unsigned(high - low + 1)));
  return numbers;
}

}  // namespace vdb_madf::test
