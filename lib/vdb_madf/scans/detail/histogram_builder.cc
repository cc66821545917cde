// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/histogram_builder.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "vdb_madf/images/detail/sample_conversion.h"

namespace vdb_madf::detail {

namespace {

/// Bins narrower than this (in powers of two) would not multiply out.
constexpr int kLeastExponent = -1000;

template <typename T>
bool isFinite(T value) {
  if constexpr (std::is_integral_v<T>)
    return true;
  else
    return std::isfinite(value);
}

/// The least exponent whose bins hold these values in less than kBins, and whole numbers below
/// 2^53; not below 0 for integers. It does not fall when the range grows.
int neededExponent(double low, double high, bool isIntegral) {
  int exponent = 0, digits = 0;
  if (!isIntegral) {
    std::frexp(std::max(std::abs(low), std::abs(high)), &digits);
    exponent = std::max(digits - 53, kLeastExponent);
  }
  std::frexp(high / 2 - low / 2, &digits);  // 2^digits <= range < 2^(digits + 1), if there is one
  if (high > low) exponent = std::max(exponent, digits - 17);
  while (std::floor(std::ldexp(high, -exponent)) - std::floor(std::ldexp(low, -exponent)) >=
         double(HistogramBuilder::kBins))
    ++exponent;
  return exponent;
}

}  // namespace

int64_t HistogramBuilder::binOf(double value) const {
  const double scaled = value * scale_;  // below 2^53
  const auto bin = int64_t(scaled);
  return bin - (double(bin) > scaled);
}

void HistogramBuilder::widen(int exponent) {
  const int shift = std::min(exponent - exponent_, 63);
  const int64_t begin = binOf(min_), end = binOf(max_) + 1;
  std::vector<int64_t> counts(size_t{kBins}), runs(size_t{kBins});
  for (int64_t bin = begin; bin < end; ++bin) {
    const auto from = size_t(bin & (kBins - 1)), to = size_t((bin >> shift) & (kBins - 1));
    counts[to] += counts_[from];
    runs[to] += runs_[from];
  }
  counts_.swap(counts);
  runs_.swap(runs);
  setExponent(exponent);
}

void HistogramBuilder::setExponent(int exponent) {
  exponent_ = exponent;
  scale_ = std::ldexp(1, -exponent);
}

void HistogramBuilder::include(double low, double high, bool isIntegral) {
  if (!any_) {
    counts_.assign(size_t{kBins}, 0);
    runs_.assign(size_t{kBins}, 0);
    setExponent(neededExponent(low, high, isIntegral));
    min_ = low;
    max_ = high;
    any_ = true;
    return;
  }
  if (low >= min_ && high <= max_) return;
  const double newLow = std::min(low, min_), newHigh = std::max(high, max_);
  const int exponent = neededExponent(newLow, newHigh, isIntegral);
  if (exponent > exponent_) widen(exponent);
  min_ = newLow;
  max_ = newHigh;
}

void HistogramBuilder::addValue(double value, int64_t voxels) {
  if (few_.size() > kFewValues) return;
  const auto place = std::lower_bound(few_.begin(), few_.end(), std::pair(value, int64_t(0)));
  if (place == few_.end() || place->first != value)
    few_.emplace(place, value, voxels);
  else
    place->second += voxels;
}

/// True if the row has no other values than these, which are then counted: mostly so in a mask.
template <typename T>
bool HistogramBuilder::addTwoValues(const T* samples, size_t count, T low, T high) {
  size_t highs = 0, others = 0, changes = 0;
  for (size_t i = 0; i < count; ++i) {
    highs += samples[i] == high;
    others += size_t((samples[i] != low) & (samples[i] != high));
  }
  if (others > 0) return false;
  for (size_t i = 1; i < count; ++i) changes += samples[i] != samples[i - 1];
  // Each run has a beginning and an end.
  const size_t ends = changes + size_t(samples[0] == high) + size_t(samples[count - 1] == high);
  const auto highRuns = int64_t(ends / 2);
  this->count(binOf(double(high)), int64_t(highs), highRuns);
  addValue(double(high), int64_t(highs));
  whole_ &= double(high) == std::floor(double(high));
  if (highs == count) return true;
  this->count(binOf(double(low)), int64_t(count - highs), int64_t(changes) + 1 - highRuns);
  addValue(double(low), int64_t(count - highs));
  whole_ &= double(low) == std::floor(double(low));
  return true;
}

template <typename T>
void HistogramBuilder::addRuns(const T* samples, size_t count) {
  for (size_t i = 0; i < count;) {
    if (!isFinite(samples[i])) {
      ++i;
      continue;
    }
    size_t end = i + 1;
    while (end < count && samples[end] == samples[i]) ++end;
    const auto value = double(samples[i]);
    this->count(binOf(value), int64_t(end - i), 1);
    addValue(value, int64_t(end - i));
    if constexpr (!std::is_integral_v<T>) whole_ &= value == std::floor(value);
    i = end;
  }
}

template <typename T>
void HistogramBuilder::addRow(const T* samples, size_t count) {
  size_t finite = 0;
  for (size_t i = 0; i < count; ++i) finite += isFinite(samples[i]);
  finite_ += int64_t(finite);
  notFinite_ += int64_t(count - finite);
  if (finite == 0) return;
  T low = *std::find_if(samples, samples + count, isFinite<T>), high = low;
  for (size_t i = 0; i < count; ++i) {
    const T value = isFinite(samples[i]) ? samples[i] : low;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  include(double(low), double(high), std::is_integral_v<T>);
  if (finite < count || !addTwoValues(samples, count, low, high)) addRuns(samples, count);
}

void HistogramBuilder::add(const HistogramBuilder& other) {
  finite_ += other.finite_;
  notFinite_ += other.notFinite_;
  whole_ &= other.whole_;
  for (const auto& [value, voxels] : other.few_) addValue(value, voxels);
  if (!other.any_) return;
  // Integers have whole bins on both sides, so the exponents say what else to include.
  include(other.min_, other.max_, other.exponent_ >= 0);
  if (other.exponent_ > exponent_) widen(other.exponent_);
  const int shift = std::min(exponent_ - other.exponent_, 63);
  for (int64_t bin = other.binOf(other.min_); bin <= other.binOf(other.max_); ++bin) {
    const auto from = size_t(bin & (kBins - 1));
    count(bin >> shift, other.counts_[from], other.runs_[from]);
  }
}

Histogram HistogramBuilder::result(SampleType type) const {
  Histogram histogram;
  histogram.type = type;
  histogram.finite = finite_;
  histogram.notFinite = notFinite_;
  histogram.whole = whole_;
  histogram.onlyFew = few_.size() <= kFewValues;
  for (const auto& [value, voxels] : few_) {
    if (!histogram.onlyFew) break;
    histogram.few.push_back(value);
    histogram.fewCounts.push_back(voxels);
  }
  if (!any_) return histogram;
  histogram.width = std::ldexp(1, exponent_);
  histogram.first = binOf(min_);
  histogram.min = min_;
  histogram.max = max_;
  for (int64_t bin = histogram.first; bin <= binOf(max_); ++bin) {
    histogram.counts.push_back(counts_[size_t(bin & (kBins - 1))]);
    histogram.runs.push_back(runs_[size_t(bin & (kBins - 1))]);
  }
  return histogram;
}

RowParts middleRows(const ImageSize& size) {
  return [width = size.x, middle = size.y / 2](int y, int) {
    return y == middle ? std::vector{std::pair(0, width)} : std::vector<std::pair<int, int>>{};
  };
}

CountedImage::CountedImage(ImageReader& image, RowParts parts, const PaddedImage* padding)
    : image_(image), parts_(std::move(parts)), padding_(padding) {
  info_ = image.info();
  path_ = image.path();
  files_ = image.files();
}

void CountedImage::read(int first, int count, void* samples) {
  image_.read(first, count, samples);
  const auto nx = size_t(info_.size.x), ny = size_t(info_.size.y);
  withSampleType(info_.type, [&](auto sample) {
    const auto* rows = static_cast<const decltype(sample)*>(samples);
    forEachRowPart(rows, info_.size, first, count, parts_, [&](const auto* part, size_t length) {
      const auto at = size_t(part - rows);
      add(part, int(at % nx), int(at / nx % ny), first + int(at / nx / ny), length);
    });
  });
}

/// Adds a part of a row that begins at x.
template <typename T>
void CountedImage::add(const T* samples, int x, int y, int z, size_t length) {
  Counts& counts = counts_.local();
  if (!padding_) return counts.inside.addRow(samples, length);
  const int end = x + int(length);
  const auto between = [&](std::pair<int, int> row) {
    const int from = std::clamp(row.first, x, end);
    return std::pair(size_t(from - x), size_t(std::clamp(row.second, from, end) - x));
  };
  const auto [from, to] = between(padding_->apart(y, z));
  counts.outside.addRow(samples, from);
  counts.inside.addRow(samples + from, to - from);
  counts.outside.addRow(samples + to, length - to);
  const auto [first, last] = between(padding_->within(y, z));
  counts.padding += int64_t(first + length - last);
}

Histogram CountedImage::histogram() const {
  HistogramBuilder all, inside;
  int64_t padding = 0;
  for (const Counts& counts : counts_) {
    inside.add(counts.inside);
    all.add(counts.inside);
    all.add(counts.outside);
    padding += counts.padding;
  }
  Histogram histogram = all.result(info_.type);
  histogram.corner = padding_ ? padding_->corner() : std::nullopt;
  if (!histogram.corner || padding == 0) return histogram;
  histogram.padding = padding;
  auto rest = std::make_shared<const Histogram>(inside.result(info_.type));
  if (rest->finite > 0) histogram.inside = std::move(rest);
  return histogram;
}

}  // namespace vdb_madf::detail
