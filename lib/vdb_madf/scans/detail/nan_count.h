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

/// Reads another image and counts, in the parts of rows that count, the samples that are no number.
class NanCount : public ImageReader {
 public:
  /// @param parts absent: whole rows
  NanCount(ImageReader& image, RowParts parts) : image_(image), parts_(std::move(parts)) {
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
                       [&](const T* values, size_t length) { voxels_ += nansOf(values, length); });
    });
  }
  int64_t voxels() const { return voxels_; }  ///< of the slices read so far

 private:
  template <typename T>
  static int64_t nansOf(const T* values, size_t count) {
    int64_t nans = 0;
    for (size_t i = 0; i < count; ++i) nans += std::isnan(values[i]);
    return nans;
  }

  ImageReader& image_;
  const RowParts parts_;
  std::atomic<int64_t> voxels_{0};
};

}  // namespace vdb_madf::detail
