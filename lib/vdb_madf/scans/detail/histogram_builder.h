// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/scans/detail/padded_image.h"
#include "vdb_madf/scans/histogram.h"

namespace vdb_madf::detail {

/// Gathers a Histogram from rows of samples; any two builders that saw the same rows, in whatever
/// order and however divided, give the same.
class HistogramBuilder {
 public:
  static constexpr int64_t kBins = int64_t(1) << 16;

  template <typename T>
  void addRow(const T* samples, size_t count);
  void add(const HistogramBuilder& other);
  Histogram result(SampleType type) const;

 private:
  template <typename T>
  bool addTwoValues(const T* samples, size_t count, T low, T high);
  template <typename T>
  void addRuns(const T* samples, size_t count);

  /// Makes the bins wide enough for these values, too.
  void include(double low, double high, bool isIntegral);
  void widen(int exponent);
  void setExponent(int exponent);
  void addValue(double value, int64_t voxels);
  int64_t binOf(double value) const;
  void count(int64_t bin, int64_t voxels, int64_t runs) {
    counts_[size_t(bin & (kBins - 1))] += voxels;
    runs_[size_t(bin & (kBins - 1))] += runs;
  }

  // Bins span less than kBins, so that each has a place of its own modulo kBins.
  std::vector<int64_t> counts_, runs_;
  int exponent_ = 0;  // of the width
  double scale_ = 1;  // one over the width
  bool any_ = false;
  double min_ = 0, max_ = 0;
  int64_t finite_ = 0, notFinite_ = 0;
  bool whole_ = true;
  // Ascending, with their voxels; one more than kFewValues if there are more.
  std::vector<std::pair<double, int64_t>> few_;
};

/// The parts of a row of an image that count, [begin, end) along x.
using RowParts = std::function<std::vector<std::pair<int, int>>(int y, int z)>;

/// The row in the middle of each slice.
RowParts middleRows(const ImageSize& size);

/// Calls f(samples, count) for these parts of the rows of `count` slices from `first` on, in
/// parallel. \p parts absent: whole rows
template <typename T, typename F>
void forEachRowPart(const T* samples, const ImageSize& size, int first, int count,
                    const RowParts& parts, const F& f) {
  constexpr size_t kRowsPerChunk = 16;
  const auto nx = size_t(size.x), ny = size_t(size.y);
  parallelForEach(ny * size_t(count), kRowsPerChunk, nullptr, [&](size_t row) {
    const T* const begin = samples + row * nx;
    if (!parts) {
      f(begin, nx);
      return;
    }
    for (const auto& [from, to] : parts(int(row % ny), first + int(row / ny)))
      f(begin + from, size_t(to - from));
  });
}

/// Reads another image and counts what it reads.
class CountedImage : public ImageReader {
 public:
  /// @param parts absent: whole rows
  /// @param padding of the scan that the image is, or is made of; absent: it is not looked for
  CountedImage(ImageReader& image, RowParts parts, const PaddedImage* padding = nullptr);
  void read(int first, int count, void* samples) override;
  Histogram histogram() const;  ///< of the slices read so far

 private:
  struct Counts {
    HistogramBuilder inside, outside;
    int64_t padding = 0;
  };
  template <typename T>
  void add(const T* samples, int x, int y, int z, size_t length);

  ImageReader& image_;
  const RowParts parts_;
  const PaddedImage* const padding_;
  mutable PerThread<Counts> counts_;
};

}  // namespace vdb_madf::detail
