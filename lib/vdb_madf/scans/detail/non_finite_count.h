// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/scans/detail/histogram_builder.h"

namespace vdb_madf::detail {

/// Reads another image and counts, in the parts of rows that count, the samples that are NaN, and
/// those that are infinite.
class NonFiniteCount : public ImageReader {
 public:
  /// @param parts absent: whole rows
  NonFiniteCount(ImageReader& image, RowParts parts) : image_(image), parts_(std::move(parts)) {
    info_ = image.info();
    path_ = image.path();
    files_ = image.files();
  }
  void read(int first, int count, void* samples) override {
    image_.read(first, count, samples);
    withSampleType(info_.type, [&](auto sample) {
      using T = decltype(sample);
      if constexpr (std::is_floating_point_v<T>)
        forEachRowPart(static_cast<const T*>(samples), info_.size, first, count, parts_,
                       [&](const T* values, size_t length) { add(values, length); });
    });
  }
  int64_t nans() const { return nans_; }  ///< of the slices read so far
  int64_t infinities() const { return infinities_; }

 private:
  template <typename T>
  void add(const T* values, size_t length) {
    int64_t nans = 0, infinities = 0;
    for (size_t i = 0; i < length; ++i) {
      nans += std::isnan(values[i]);
      infinities += std::isinf(values[i]);
    }
    nans_ += nans;
    infinities_ += infinities;
  }

  ImageReader& image_;
  const RowParts parts_;
  std::atomic<int64_t> nans_{0}, infinities_{0};
};

}  // namespace vdb_madf::detail
