// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/filtered_image.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <vector>

#include "vdb_madf/base/detail/gaussian.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/simd.h"
#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/scans/detail/slice_window.h"

namespace vdb_madf {

namespace {

using detail::mirrored;
using detail::SliceWindow;

constexpr size_t kRowsPerChunk = 4;

template <typename T>
bool isNan(T value) {
  return value != value;
}

/// An image made of another one.
class FilteredImage : public ImageReader {
 protected:
  explicit FilteredImage(std::unique_ptr<ImageReader> image) : image_(std::move(image)) {
    info_ = image_->info();
    path_ = image_->path();
    files_ = image_->files();
  }
  size_t rowLength() const { return size_t(info_.size.x); }

  /// f(y, z, row) for the rows of slices [first, first + count), in parallel; `row` counts from the
  /// first.
  template <typename F>
  void forEachRow(int first, int count, const F& f) const {
    const auto ny = size_t(info_.size.y);
    detail::parallelForEach(ny * size_t(count), kRowsPerChunk, nullptr,
                            [&](size_t row) { f(int(row % ny), first + int(row / ny), row); });
  }

  /// Whether all values of slices [first, first + count), and of those within `radius` of them, are
  /// numbers.
  template <typename T>
  bool allKnown(const SliceWindow<T>& window, int radius, int first, int count) const {
    const SampleType type = image_->info().type;
    if (type != SampleType::float32 && type != SampleType::float64) return true;
    std::atomic<bool> all{true};
    forEachRow(first - radius, count + 2 * radius, [&](int y, int z, size_t) {
      const T* row = window.row(y, z);
      if (std::any_of(row, row + rowLength(), isNan<T>)) all = false;
    });
    return all;
  }

  std::unique_ptr<ImageReader> image_;
};

/// Lanes next to each other along x whose medians are found together.
constexpr size_t kLanes = 64;

/// Puts the smaller of two values into a, lane by lane.
template <typename T>
void order(T* a, T* b) {
  for (size_t i = 0; i < kLanes; ++i) {
    const bool swap = b[i] < a[i];
    const T low = swap ? b[i] : a[i], high = swap ? a[i] : b[i];
    a[i] = low;
    b[i] = high;
  }
}

/// The median of an odd number of values in each lane. Of one value more than half of them the
/// least and the greatest are not it: they are dropped, the next value is added, and so on.
/// `fetch(i, to)` writes the values number i; `work` has room for count / 2 + 2.
template <typename T, typename Fetch>
const T* medians(size_t count, const Fetch& fetch, T* work) {
  size_t held = count / 2 + 2, next = held;
  for (size_t i = 0; i < held; ++i) fetch(i, work + i * kLanes);
  for (;;) {
    const auto lane = [&](size_t i) { return work + i * kLanes; };
    for (size_t i = 0; i < held / 2; ++i) order(lane(i), lane(held - 1 - i));
    for (size_t i = 1; i < (held + 1) / 2; ++i) order(lane(0), lane(i));
    for (size_t i = held / 2; i + 1 < held; ++i) order(lane(i), lane(held - 1));
    if (next == count) return lane(held / 2);
    fetch(next++, lane(0));
    --held;
  }
}

template <typename T>
class MedianImage : public FilteredImage {
 public:
  MedianImage(std::unique_ptr<ImageReader> image, int radius)
      : FilteredImage(std::move(image)), radius_(radius), window_(*image_, radius) {}

  void read(int first, int count, void* samples) override {
    detail::checkSlices(path_, info_, first, count);
    window_.moveTo(first, count);
    allKnown_ = allKnown(window_, radius_, first, count);
    auto* to = static_cast<T*>(samples);
    detail::PerThread<Scratch> scratches;
    forEachRow(first, count, [&](int y, int z, size_t row) {
      filterRow(y, z, scratches.local(), to + row * rowLength());
    });
  }

 private:
  struct Scratch {
    std::vector<T> rows, work;
  };

  void filterRow(int y, int z, Scratch& scratch, T* to) const {
    const auto side = size_t(2 * radius_ + 1);
    const size_t length = rowLength() + side + kLanes;  // room for the lanes of the last block
    scratch.rows.resize(side * side * length);
    scratch.work.resize((side * side * side / 2 + 2) * kLanes);
    T* row = scratch.rows.data();
    for (int dz = -radius_; dz <= radius_; ++dz)
      for (int dy = -radius_; dy <= radius_; ++dy, row += length) {
        const T* from = window_.row(y + dy, z + dz);
        std::copy(from, from + rowLength(), row + radius_);
        for (int i = 1; i <= radius_; ++i) {
          row[radius_ - i] = from[mirrored(-i, info_.size.x)];
          row[size_t(radius_ + i) + rowLength() - 1] =
              from[mirrored(info_.size.x - 1 + i, info_.size.x)];
        }
      }
    if (!allKnown_ && std::any_of(scratch.rows.begin(), scratch.rows.end(), isNan<T>))
      return filterKnown(window_.row(y, z), length, scratch, to);
    for (size_t x = 0; x < rowLength(); x += kLanes) {
      const auto fetch = [&](size_t i, T* lanes) {
        const T* from = scratch.rows.data() + i / side * length + x + i % side;
        std::copy(from, from + kLanes, lanes);
      };
      const T* median = medians(side * side * side, fetch, scratch.work.data());
      std::copy(median, median + std::min(kLanes, rowLength() - x), to + x);
    }
  }

  /// The same of the values that are no NaN; of an even number the lower middle one.
  void filterKnown(const T* middle, size_t length, Scratch& scratch, T* to) const {
    const auto side = size_t(2 * radius_ + 1);
    std::vector<T>& known = scratch.work;
    for (size_t x = 0; x < rowLength(); ++x) {
      to[x] = middle[x];
      if (isNan(middle[x])) continue;
      known.clear();
      for (size_t row = 0; row < side * side; ++row)
        std::copy_if(&scratch.rows[row * length + x], &scratch.rows[row * length + x] + side,
                     std::back_inserter(known), [](T value) { return !isNan(value); });
      const auto half = known.begin() + std::ptrdiff_t((known.size() - 1) / 2);
      std::nth_element(known.begin(), half, known.end());
      to[x] = *half;
    }
  }

  int radius_;
  SliceWindow<T> window_;
  bool allKnown_ = true;  // of the slices that are read
};

// Each lane by itself, so that vectors of any width give the same bits.
template <typename T>
VDB_MADF_KERNEL void scale(const T* in, double weight, double* sums, size_t count) {
  for (size_t i = 0; i < count; ++i) sums[i] = weight * double(in[i]);
}
template <typename T>
VDB_MADF_KERNEL void addPair(const T* a, const T* b, double weight, double* sums, size_t count) {
  for (size_t i = 0; i < count; ++i) sums[i] += weight * (double(a[i]) + double(b[i]));
}

/// T: float or double.
template <typename T>
class SmoothedImage : public FilteredImage {
 public:
  SmoothedImage(std::unique_ptr<ImageReader> image, double sigma)
      : FilteredImage(std::move(image)),
        weights_(detail::gaussianWeights(sigma)),
        window_(*image_, radius()) {
    info_.type = std::is_same_v<T, float> ? SampleType::float32 : SampleType::float64;
  }

  void read(int first, int count, void* samples) override {
    detail::checkSlices(path_, info_, first, count);
    window_.moveTo(first, count);
    auto* to = static_cast<T*>(samples);
    const auto inWindow = [&](int y, int z) { return window_.row(y, z); };
    if (allKnown(window_, radius(), first, count))
      smooth(inWindow, first, count, to);
    else
      smoothKnown(first, count, to);
  }

 private:
  struct Scratch {
    std::vector<double> sums;
    std::vector<T> row;
  };
  int radius() const { return int(weights_.size()) - 1; }

  /// Where values are NaN, their place stays NaN, and around it the others have all the weight: a
  /// sum of known values is divided by that of ones in their places. Where all are known it stands
  /// as it is, so that the bits do not depend on what else is in the window.
  void smoothKnown(int first, int count, T* to) {
    const int begin = first - radius();
    const size_t slice = size_t(info_.size.y) * rowLength();
    std::vector<T> values(slice * size_t(count + 2 * radius())), ones(values.size());
    forEachRow(begin, count + 2 * radius(), [&](int y, int z, size_t row) {
      const T* from = window_.row(y, z);
      for (size_t x = 0; x < rowLength(); ++x) {
        const bool isKnown = !isNan(from[x]);
        values[row * rowLength() + x] = isKnown ? from[x] : 0;
        ones[row * rowLength() + x] = isKnown;
      }
    });
    const auto rowsOf = [&](const std::vector<T>& all) {
      return [&](int y, int z) {
        return &all[(size_t(z - begin) * size_t(info_.size.y) + size_t(y)) * rowLength()];
      };
    };
    std::vector<T> weights(slice * size_t(count));
    smooth(rowsOf(ones), first, count, weights.data());
    smooth(rowsOf(values), first, count, to);
    T whole = 1;
    for (int axis = 0; axis < 3; ++axis) {
      double sum = weights_[0] * double(whole);
      for (int k = radius(); k > 0; --k)
        sum += weights_[size_t(k)] * (double(whole) + double(whole));
      whole = T(sum);
    }
    forEachRow(first, count, [&](int y, int z, size_t row) {
      const T* from = window_.row(y, z);
      for (size_t x = 0, i = row * rowLength(); x < rowLength(); ++x, ++i)
        if (isNan(from[x]))
          to[i] = from[x];
        else if (weights[i] != whole)
          to[i] /= weights[i];
    });
  }

  /// Slices [first, first + count) of an image whose rows are rowAt(y, z).
  template <typename RowAt>
  void smooth(const RowAt& rowsAt, int first, int count, T* to) {
    const auto ny = size_t(info_.size.y);
    alongZ_.resize(ny * rowLength() * size_t(count));
    detail::PerThread<Scratch> scratches;
    forEachRow(first, count, [&](int y, int z, size_t row) {
      convolve([&](int k) { return rowsAt(y, z + k); }, scratches.local(),
               &alongZ_[row * rowLength()]);
    });
    forEachRow(first, count, [&](int y, int z, size_t row) {
      Scratch& scratch = scratches.local();
      const size_t slice = size_t(z - first) * ny;
      const auto rowAt = [&](int k) {
        return &alongZ_[(slice + size_t(mirrored(y + k, info_.size.y))) * rowLength()];
      };
      scratch.row.resize(rowLength() + 2 * size_t(radius()));
      T* middle = scratch.row.data() + radius();
      convolve(rowAt, scratch, middle);
      for (int i = 1; i <= radius(); ++i) {
        middle[-i] = middle[mirrored(-i, info_.size.x)];
        middle[info_.size.x - 1 + i] = middle[mirrored(info_.size.x - 1 + i, info_.size.x)];
      }
      convolve([&](int k) { return middle + k; }, scratch, to + row * rowLength());
    });
  }

  /// The weighted sum of rows rowAt(-radius) .. rowAt(radius).
  template <typename RowAt>
  void convolve(const RowAt& rowAt, Scratch& scratch, T* to) const {
    const size_t count = rowLength();
    scratch.sums.resize(count);
    double* sums = scratch.sums.data();
    detail::atBestLevel([&]() VDB_MADF_INLINE { scale(rowAt(0), weights_[0], sums, count); });
    for (int k = radius(); k > 0; --k)
      detail::atBestLevel([&]() VDB_MADF_INLINE {
        addPair(rowAt(-k), rowAt(k), weights_[size_t(k)], sums, count);
      });
    for (size_t i = 0; i < count; ++i) to[i] = T(sums[i]);
  }

  std::vector<double> weights_;
  SliceWindow<T> window_;
  std::vector<T> alongZ_;
};

}  // namespace

std::unique_ptr<ImageReader> medianImage(std::unique_ptr<ImageReader> image, int radius) {
  if (radius < 1 || radius > kMaxMedianRadius)
    throw InvalidInput(fmt::format("the radius of a median is 1 to {} voxels, and {} was given",
                                   kMaxMedianRadius, radius));
  std::unique_ptr<ImageReader> median;
  detail::withSampleType(image->info().type, [&](auto sample) {
    median = std::make_unique<MedianImage<decltype(sample)>>(std::move(image), radius);
  });
  return median;
}

std::unique_ptr<ImageReader> smoothedImage(std::unique_ptr<ImageReader> image, double sigma) {
  if (!(sigma >= kMinSmoothing && sigma <= kMaxSmoothing))
    throw InvalidInput("the Gaussian's standard deviation lies between " +
                       detail::shortestDecimal(kMinSmoothing) + " and " +
                       detail::shortestDecimal(kMaxSmoothing) + " voxels, and " +
                       detail::shortestDecimal(sigma) + " was given");
  const SampleType type = image->info().type;
  if (type == SampleType::uint32 || type == SampleType::int32 || type == SampleType::float64)
    return std::make_unique<SmoothedImage<double>>(std::move(image), sigma);
  return std::make_unique<SmoothedImage<float>>(std::move(image), sigma);
}

}  // namespace vdb_madf
