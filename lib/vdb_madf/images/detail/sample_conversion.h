// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <string>
#include <type_traits>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Calls f(T()) with the C++ type of a sample type.
template <typename F>
auto withSampleType(SampleType type, const F& f) {
  switch (type) {
    case SampleType::uint8:
      return f(uint8_t());
    case SampleType::int8:
      return f(int8_t());
    case SampleType::uint16:
      return f(uint16_t());
    case SampleType::int16:
      return f(int16_t());
    case SampleType::uint32:
      return f(uint32_t());
    case SampleType::int32:
      return f(int32_t());
    case SampleType::float32:
      return f(float());
    case SampleType::float64:
      break;
  }
  return f(double());
}

/// True if the sample type can hold the value. Integers must be met exactly, also in float types
/// (a label must not become its neighbor); a double becomes the nearest float.
template <typename Sample, typename Value>
bool fits(Value value) {
  using Limits = std::numeric_limits<Sample>;
  if constexpr (std::is_same_v<Sample, Value>) {
    return true;
  } else if constexpr (std::is_integral_v<Sample> && std::is_integral_v<Value>) {
    return int64_t(value) >= int64_t(Limits::lowest()) && int64_t(value) <= int64_t(Limits::max());
  } else if constexpr (std::is_integral_v<Sample>) {
    return double(value) >= double(Limits::lowest()) && double(value) <= double(Limits::max()) &&
           std::trunc(value) == value;
  } else if constexpr (std::is_integral_v<Value>) {
    constexpr int64_t kExact = int64_t(1) << Limits::digits;
    return int64_t(value) >= -kExact && int64_t(value) <= kExact;
  } else {
    return !(std::abs(double(value)) > double(Limits::max())) || std::isinf(value);
  }
}

template <typename Value>
[[noreturn]] void failToFit(const std::string& path, Value value, SampleType type) {
  std::string text;
  if constexpr (std::is_integral_v<Value>)
    text = std::to_string(value);
  else
    text = shortestDecimal(double(value));
  throw InvalidInput(path + ": the value " + text + " does not fit " + sampleTypeName(type) +
                     ": choose another sample type (labels: whole numbers below 2^31)");
}

/// samples[i] = values[i], in parallel. @throw InvalidInput that names the file and the first value
/// that does not fit, however many threads look.
template <typename Sample, typename Value>
void convertSamples(const std::string& path, const Value* values, size_t count, SampleType type,
                    Sample* samples) {
  constexpr size_t kSamplesPerChunk = size_t(1) << 18;
  std::mutex mutex;
  size_t firstMisfit = count;
  parallelFor(count, kSamplesPerChunk, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (!fits<Sample>(values[i])) {
        const std::lock_guard<std::mutex> lock(mutex);
        firstMisfit = std::min(firstMisfit, i);
        return;
      }
      samples[i] = Sample(values[i]);
    }
  });
  if (firstMisfit < count) failToFit(path, values[firstMisfit], type);
}

}  // namespace vdb_madf::detail
