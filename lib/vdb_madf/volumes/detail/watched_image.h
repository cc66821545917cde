// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <type_traits>

#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// An image, and whether the samples that were read of it look like labels: whole numbers, and
/// several of them besides 0.
class WatchedImage : public ImageReader {
 public:
  explicit WatchedImage(ImageReader& image) : image_(image) {
    info_ = image.info();
    path_ = image.path();
    files_ = image.files();
  }

  void read(int first, int count, void* samples) override {
    image_.read(first, count, samples);
    withSampleType(info_.type, [&](auto sample) {
      using Sample = decltype(sample);
      if constexpr (std::is_integral_v<Sample>) {
        const auto* begin = static_cast<const Sample*>(samples);
        watch(begin, begin + sliceBytes(info_) / sizeof(Sample) * size_t(count));
      }
    });
  }
  bool looksLikeLabels() const { return several_; }

 private:
  template <typename Sample>
  void watch(const Sample* begin, const Sample* end) {
    if (several_) return;
    for (const Sample* sample = begin; sample != end; ++sample) {
      if (*sample == 0 || int64_t(*sample) == value_) continue;
      several_ = value_ != 0;
      value_ = int64_t(*sample);
      if (several_) return;
    }
  }

  ImageReader& image_;
  int64_t value_ = 0;  ///< the first that is not 0
  bool several_ = false;
};

}  // namespace vdb_madf::detail
