// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/image.h"

namespace vdb_madf::detail {

/// Index i in the mirror images of [0, size) on both sides: ... 1 0 | 0 1 ... | size - 1 ...
inline int mirrored(int i, int size) {
  const int period = 2 * size;
  i = (i % period + period) % period;
  return i < size ? i : period - 1 - i;
}

/// Slices of an image, as samples of type T, that are held while a slab moves through it.
template <typename T>
class SliceWindow {
 public:
  SliceWindow(ImageReader& image, int radius) : image_(image), radius_(radius) {}

  /// Holds the slices [first, first + count) and `radius` more on either side, as far as they
  /// exist. What is held already is not read again.
  void moveTo(int first, int count) {
    const int depth = image_.info().size.z;
    const int begin = std::max(0, first - radius_);
    if (begin < begin_) end_ = 0;  // back: for images that can go there
    const int kept = std::max(0, end_ - begin);
    const int end = std::max(begin + kept, std::min(depth, first + count + radius_));
    if (kept > 0)
      std::copy(samples_.end() - std::ptrdiff_t(size_t(kept) * slice()), samples_.end(),
                samples_.begin());
    begin_ = begin;
    samples_.resize(size_t(end - begin) * slice());
    end_ = begin + kept;
    if (end > end_) readInto(end_, end, samples_.data() + size_t(kept) * slice());
    end_ = end;
  }

  /// Row y of slice z; both may lie beyond the faces.
  const T* row(int y, int z) const {
    const ImageSize& size = image_.info().size;
    const auto at =
        size_t(mirrored(z, size.z) - begin_) * size_t(size.y) + size_t(mirrored(y, size.y));
    return samples_.data() + at * size_t(size.x);
  }

 private:
  size_t slice() const { return size_t(image_.info().size.x) * size_t(image_.info().size.y); }
  /// Reads one slice after the other where they have to be converted.
  void readInto(int begin, int end, T* to) {
    withSampleType(image_.info().type, [&](auto sample) {
      using Sample = decltype(sample);
      if constexpr (std::is_same_v<Sample, T>) {
        image_.read(begin, end - begin, to);
      } else {
        std::vector<Sample> from(slice());
        for (int z = begin; z < end; ++z, to += slice()) {
          image_.read(z, 1, from.data());
          std::transform(from.begin(), from.end(), to, [](Sample value) { return T(value); });
        }
      }
    });
  }

  ImageReader& image_;
  int radius_, begin_ = 0, end_ = 0;
  std::vector<T> samples_;
};

}  // namespace vdb_madf::detail
