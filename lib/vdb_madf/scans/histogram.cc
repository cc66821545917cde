// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/histogram.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "vdb_madf/base/detail/text.h"
#include "vdb_madf/base/digits.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/detail/histogram_builder.h"

namespace vdb_madf {

namespace {

/// Bins of a histogram whose modes are looked for.
constexpr size_t kModeBins = 256;
constexpr int kMaxRounds = 10000;
/// Voxels in a run of a label, on average.
constexpr int64_t kLabelRun = 3;

bool hasBinPerValue(const Histogram& histogram) {
  return histogram.whole && histogram.width == 1;
}

/// The mean of three neighbors; beyond the ends stands the last bin again.
std::vector<double> smoothed(const std::vector<double>& bins) {
  std::vector<double> means(bins.size());
  for (size_t i = 0; i < bins.size(); ++i)
    means[i] = (bins[i == 0 ? 0 : i - 1] + bins[i] + bins[std::min(i + 1, bins.size() - 1)]) / 3;
  return means;
}

/// Bins after which it falls, having risen before (or from the first on); of a plateau the last.
std::vector<size_t> maxima(const std::vector<double>& bins) {
  std::vector<size_t> found;
  bool rising = true;
  for (size_t i = 0; i + 1 < bins.size(); ++i) {
    if (rising && bins[i + 1] < bins[i]) {
      rising = false;
      found.push_back(i);
    } else if (!rising && bins[i + 1] > bins[i]) {
      rising = true;
    }
  }
  return found;
}

}  // namespace

Histogram histogramOf(ImageReader& image, Interrupter* interrupter) {
  const ImageInfo& info = image.info();
  std::vector<char> samples(size_t(detail::sliceBytes(info)) *
                            size_t(std::min(detail::kSlab, info.size.z)));
  detail::PaddedImage padded(image);
  detail::CountedImage counted(padded, nullptr, &padded);
  detail::forEachSlab(0, info.size.z, interrupter,
                      [&](int z, int count) { counted.read(z, count, samples.data()); });
  return counted.histogram();
}

ImageKind kindOf(const Histogram& histogram) {
  const std::vector<double>& few = histogram.few;
  if (histogram.onlyFew && (few.size() < 2 || (few.size() == 2 && (few[0] == 0 || few[1] == 0))))
    return ImageKind::mask;
  if (!histogram.whole) return ImageKind::gray;
  if (histogram.onlyFew) return ImageKind::phases;
  size_t bins = 0, labels = 0;
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    if (histogram.counts[i] == 0 || histogram.first + int64_t(i) == 0) continue;
    ++bins;
    labels += histogram.counts[i] >= kLabelRun * histogram.runs[i];
  }
  return 2 * labels >= bins ? ImageKind::labels : ImageKind::gray;
}

double meanRun(const Histogram& histogram) {
  int64_t voxels = 0, runs = 0;
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    if (histogram.first + int64_t(i) == 0) continue;
    voxels += histogram.counts[i];
    runs += histogram.runs[i];
  }
  return runs > 0 ? double(voxels) / double(runs) : 1;
}

int64_t countLabels(const Histogram& histogram, ImageReader& image, Interrupter* interrupter) {
  int64_t labels = 0;
  if (histogram.width <= 1) {
    for (size_t i = 0; i < histogram.counts.size(); ++i)
      labels += histogram.counts[i] > 0 && histogram.first + int64_t(i) != 0;
    return labels;
  }
  std::unordered_set<int64_t> values;
  const ImageInfo& info = image.info();
  const size_t slice = size_t(info.size.x) * size_t(info.size.y);
  std::vector<char> samples(slice * sampleSize(info.type) * size_t(detail::kSlab));
  detail::forEachSlab(0, info.size.z, interrupter, [&](int z, int count) {
    image.read(z, count, samples.data());
    detail::withSampleType(info.type, [&](auto sample) {
      const auto* value = reinterpret_cast<const decltype(sample)*>(samples.data());
      for (size_t i = 0; i < slice * size_t(count); ++i)
        if (value[i] != 0 && (i == 0 || value[i] != value[i - 1])) values.insert(int64_t(value[i]));
    });
  });
  return int64_t(values.size());
}

double valueSpread(ImageReader& image, Interrupter* interrupter) {
  constexpr int64_t kMostVoxels = int64_t(1) << 26;
  constexpr size_t kMostValues = 65536;  // that were met first
  const ImageInfo& info = image.info();
  const int64_t slice = int64_t(info.size.x) * info.size.y;
  const int64_t step = 1 + slice * info.size.z / kMostVoxels;
  std::unordered_map<int64_t, std::pair<CoordBBox, int64_t>> places;  // box, voxels
  std::vector<char> samples(size_t(slice) * sampleSize(info.type) * size_t(detail::kSlab));
  detail::forEachSlab(0, info.size.z, interrupter, [&](int z, int count) {
    if (z / detail::kSlab % step != 0) return;
    image.read(z, count, samples.data());
    detail::withSampleType(info.type, [&](auto sample) {
      const auto* value = reinterpret_cast<const decltype(sample)*>(samples.data());
      Coord p;
      for (p.z() = z; p.z() < z + count; ++p.z())
        for (p.y() = 0; p.y() < info.size.y; ++p.y())
          for (p.x() = 0; p.x() < info.size.x; ++p.x(), ++value) {
            if (*value == 0 || (places.size() == kMostValues && places.count(int64_t(*value)) == 0))
              continue;
            auto& [box, voxels] = places[int64_t(*value)];
            box.expand(p);
            ++voxels;
          }
    });
  });
  double sum = 0;
  int64_t several = 0;
  for (const auto& [value, place] : places) {
    if (place.second < 2) continue;
    ++several;
    int axes = 0;
    double parts = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (info.size[axis] < 2) continue;
      ++axes;
      parts += double(place.first.dim()[axis] - 1) / (info.size[axis] - 1);
    }
    sum += parts / axes;
  }
  return several > 0 ? sum / double(several) : 1;
}

std::optional<double> otsuThreshold(const Histogram& histogram) {
  // Bins are numbered from 0: sums of up to 2^16 times the voxels are exact.
  const std::vector<int64_t>& counts = histogram.counts;
  int64_t sum = 0, sumBelow = 0, below = 0;
  for (size_t i = 0; i < counts.size(); ++i) sum += counts[i] * int64_t(i);
  double largest = -1;
  size_t last = 0;
  for (size_t i = 0; i + 1 < counts.size(); ++i) {
    below += counts[i];
    sumBelow += counts[i] * int64_t(i);
    const auto lower = double(below), upper = double(histogram.finite - below);
    const double difference = double(sumBelow) / lower - double(sum - sumBelow) / upper;
    const double variance = lower * upper * difference * difference;
    if (variance <= largest) continue;
    largest = variance;
    last = i;
  }
  if (largest < 0) return std::nullopt;
  size_t next = last + 1;
  while (counts[next] == 0) ++next;
  return (histogram.lowerEdge(last + 1) + histogram.lowerEdge(next)) / 2;
}

std::optional<double> valleyThreshold(const Histogram& histogram) {
  const bool direct = hasBinPerValue(histogram) && histogram.counts.size() <= kModeBins;
  std::vector<double> bins(histogram.counts.begin(), histogram.counts.end());
  if (!direct) bins = gathered(histogram, histogram.min, histogram.max, kModeBins);
  for (int round = 0; round < kMaxRounds; ++round) {
    bins = smoothed(bins);
    const std::vector<size_t> modes = maxima(bins);
    if (modes.size() > 2) continue;
    if (modes.size() < 2) return std::nullopt;
    const auto least = std::min_element(bins.begin() + std::ptrdiff_t(modes[0]),
                                        bins.begin() + std::ptrdiff_t(modes[1]) + 1);
    const auto bin = size_t(least - bins.begin());
    if (direct) return histogram.lowerEdge(bin + 1);
    const double half = histogram.max / 2 - histogram.min / 2;  // the whole may not be finite
    return histogram.min + half * ((2 * double(bin) + 1) / double(kModeBins));
  }
  return std::nullopt;
}

int64_t voxelsFrom(const Histogram& histogram, double threshold) {
  int64_t voxels = 0;
  for (size_t i = histogram.counts.size(); i > 0 && histogram.lowerEdge(i - 1) >= threshold; --i)
    voxels += histogram.counts[i - 1];
  return voxels;
}

int64_t voxelsAround(const Histogram& histogram, double value) {
  const double bin = std::floor(value / histogram.width) - double(histogram.first);
  return bin >= 0 && bin < double(histogram.counts.size()) ? histogram.counts[size_t(bin)] : 0;
}

double quantile(const Histogram& histogram, double share) {
  int64_t below = 0;
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    below += histogram.counts[i];
    if (double(below) > share * double(histogram.finite)) return histogram.lowerEdge(i);
  }
  return histogram.max;
}

std::vector<double> gathered(const Histogram& histogram, double low, double high, size_t bins) {
  std::vector<double> sums(bins);
  for (size_t i = 0; i < histogram.counts.size(); ++i) {
    const double middle = histogram.lowerEdge(i) + (histogram.whole ? 0 : histogram.width / 2);
    const double value = std::min(std::max(middle, histogram.min), histogram.max);
    const double place = (value / 2 - low / 2) / (high / 2 - low / 2) * double(bins);
    if (place >= 0 && value <= high && histogram.counts[i] > 0)
      sums[std::min(size_t(place), bins - 1)] += double(histogram.counts[i]);
  }
  return sums;
}

std::string histogramLine(const Histogram& histogram, size_t characters) {
  if (histogram.counts.empty()) return "no finite values";
  constexpr char kHeights[] = " .:-=+*#%@";
  constexpr size_t kLargest = sizeof kHeights - 2;
  const double low = quantile(histogram, 0.001), high = quantile(histogram, 0.999);
  if (high > low) {
    const std::vector<double> bins = gathered(histogram, low, high, characters);
    const double most = *std::max_element(bins.begin(), bins.end());
    std::string line;
    for (const double bin : bins)
      line += kHeights[size_t(std::ceil(std::sqrt(bin / most) * double(kLargest)))];
    const int digits = digitsApart(low, high, 6);
    return detail::generalDecimal(low, digits) + " |" + line + "| " +
           detail::generalDecimal(high, digits);
  }
  return detail::generalDecimal(low, 6) + " |" + kHeights[kLargest] + "| " +
         detail::generalDecimal(high, 6);
}

}  // namespace vdb_madf
