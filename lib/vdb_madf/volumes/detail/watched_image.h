// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>
#include <utility>

#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// An image that tells, while it is read, that its samples look like labels: whole numbers, and
/// several of them besides 0.
class WatchedImage : public ImageReader {
 public:
  /// @param looksLikeLabels set once it is so; has to live as long
  WatchedImage(std::unique_ptr<ImageReader> image, bool& looksLikeLabels)
      : image_(std::move(image)), looksLikeLabels_(looksLikeLabels) {
    info_ = image_->info();
    path_ = image_->path();
    files_ = image_->files();
    notes_ = image_->notes();
  }

  void read(int first, int count, void* samples) override {
    image_->read(first, count, samples);
    withSampleType(info_.type, [&](auto sample) {
      using Sample = decltype(sample);
      if constexpr (std::is_integral_v<Sample>) {
        const auto* begin = static_cast<const Sample*>(samples);
        watch(begin, begin + sliceBytes(info_) / sizeof(Sample) * size_t(count));
      }
    });
  }

 private:
  template <typename Sample>
  void watch(const Sample* begin, const Sample* end) {
    for (const Sample* sample = begin; sample != end && !looksLikeLabels_; ++sample) {
      if (*sample == 0 || int64_t(*sample) == value_) continue;
      looksLikeLabels_ = value_ != 0;
      value_ = int64_t(*sample);
    }
  }

  std::unique_ptr<ImageReader> image_;
  bool& looksLikeLabels_;
  int64_t value_ = 0;  ///< the first that is not 0
};

}  // namespace vdb_madf::detail
