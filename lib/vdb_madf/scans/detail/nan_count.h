// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
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
      if constexpr (std::is_floating_point_v<decltype(sample)>)
        add(first, count, static_cast<const decltype(sample)*>(samples));
    });
  }
  int64_t voxels() const { return voxels_; }  ///< of the slices read so far

 private:
  template <typename T>
  void add(int first, int count, const T* samples) {
    constexpr size_t kRowsPerChunk = 64;
    const auto nx = size_t(info_.size.x), ny = size_t(info_.size.y);
    parallelForEach(ny * size_t(count), kRowsPerChunk, nullptr, [&](size_t row) {
      const T* values = samples + row * nx;
      if (!parts_) {
        voxels_ += nansOf(values, nx);
        return;
      }
      for (const auto& [from, to] : parts_(int(row % ny), first + int(row / ny)))
        voxels_ += nansOf(values + from, size_t(to - from));
    });
  }
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
