// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/gray_planes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"

namespace vdb_madf {

namespace {

constexpr int kSlices = 8;  // read together
constexpr double kClipped = 0.005;

/// The samples of a plane, in the order of GrayPlane.
struct Samples {
  SlicePlane plane;
  int width = 0, height = 0;
  std::vector<float> values;
};

/// Takes what planes show of the slices [z, z + count) of the scan.
template <typename T>
void take(const T* slices, int z, int count, const CoordBBox& scan, const CoordBBox& box,
          std::vector<Samples>& planes) {
  const Coord size = scan.dim();
  for (Samples& to : planes) {
    Coord low = box.min(), high = box.max();
    low[to.plane.axis] = high[to.plane.axis] = to.plane.index;
    low.z() = std::max(low.z(), z);
    high.z() = std::min(high.z(), z + count - 1);
    if (low.z() > high.z()) continue;
    for (auto p = CoordBBox(low, high).begin(); p; ++p) {
      const Coord from = (*p) - scan.min(), at = (*p) - box.min();
      to.values[size_t(at[to.plane.down()]) * size_t(to.width) + size_t(at[to.plane.right()])] =
          float(slices[(size_t((*p).z() - z) * size_t(size.y()) + size_t(from.y())) *
                           size_t(size.x()) +
                       size_t(from.x())]);
    }
  }
}

/// From black to white.
class Contrast {
 public:
  /// @param all what is to be shown, without what is not finite
  explicit Contrast(std::vector<float> all) {
    if (all.empty()) return;
    const auto clipped = std::ptrdiff_t(kClipped * double(all.size()));
    std::nth_element(all.begin(), all.begin() + clipped, all.end());
    low_ = all[size_t(clipped)];
    std::nth_element(all.begin(), all.end() - 1 - clipped, all.end());
    high_ = all[all.size() - 1 - size_t(clipped)];
  }

  uint8_t operator()(float value) const {
    if (!std::isfinite(value)) return 0;
    const double range = double(high_) - double(low_);
    const double share = range > 0 ? (double(value) - double(low_)) / range : 0.5;
    return uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0)));
  }

 private:
  float low_ = 0, high_ = 1;
};

void addFinite(const std::vector<float>& values, std::vector<float>& all) {
  std::copy_if(values.begin(), values.end(), std::back_inserter(all),
               [](float value) { return std::isfinite(value); });
}

std::vector<uint8_t> shown(const std::vector<float>& values, const Contrast& contrast) {
  std::vector<uint8_t> gray(values.size());
  std::transform(values.begin(), values.end(), gray.begin(), contrast);
  return gray;
}

/// The means of blocks, a layer of which is summed at a time.
class BlockMeans {
 public:
  BlockMeans(const CoordBBox& blocks, int factor)
      : size_(blocks.dim()),
        first_(blocks.min().x() * factor, blocks.min().y() * factor, blocks.min().z() * factor),
        factor_(factor),
        sums_(size_t(size_.x()) * size_t(size_.y())),
        counts_(sums_.size()) {
    means_.reserve(size_t(blocks.volume()));
  }

  /// A slice of a scan, by ascending z; it lies in a layer of the blocks.
  template <typename T>
  void add(const T* slice, int z, const CoordBBox& scan) {
    endLayers((z - first_.z()) / factor_);
    for (int y = std::max(0, scan.min().y() - first_.y());
         y < size_.y() * factor_ && first_.y() + y <= scan.max().y(); ++y) {
      const T* const line =
          slice + size_t(first_.y() + y - scan.min().y()) * size_t(scan.dim().x());
      const size_t row = size_t(y / factor_) * size_t(size_.x());
      for (int x = std::max(0, scan.min().x() - first_.x());
           x < size_.x() * factor_ && first_.x() + x <= scan.max().x(); ++x) {
        const auto value = double(line[first_.x() + x - scan.min().x()]);
        if (!std::isfinite(value)) continue;
        sums_[row + size_t(x / factor_)] += value;
        ++counts_[row + size_t(x / factor_)];
      }
    }
  }

  std::vector<float> result() {
    endLayers(size_.z());
    return std::move(means_);
  }

 private:
  /// Those below a layer.
  void endLayers(int layer) {
    for (; layer_ < layer; ++layer_) {
      for (size_t i = 0; i < sums_.size(); ++i)
        means_.push_back(counts_[i] > 0 ? float(sums_[i] / double(counts_[i]))
                                        : std::numeric_limits<float>::quiet_NaN());
      std::fill(sums_.begin(), sums_.end(), 0);
      std::fill(counts_.begin(), counts_.end(), 0);
    }
  }

  const Coord size_, first_;
  const int factor_;
  int layer_ = 0;
  std::vector<double> sums_;
  std::vector<uint32_t> counts_;
  std::vector<float> means_;
};

/// f(slices, z, count) for the slices of the scan in [low, high] that are wanted(z, count); f is
/// called with the type of the samples.
template <typename Wanted, typename Take>
void readSlices(GrayScan& scan, int low, int high, const Wanted& wanted, const Take& f,
                Interrupter* interrupter) {
  const CoordBBox whole = scan.box();
  const ImageInfo& info = scan.image->info();
  std::vector<char> bytes(size_t(detail::sliceBytes(info)) *
                          size_t(std::min(kSlices, whole.dim().z())));
  for (int z = low; z <= high; z += kSlices) {
    const int count = std::min(kSlices, high - z + 1);
    if (!wanted(z, count)) continue;
    const int percent = int(int64_t(z - low) * 100 / (high - low + 1));
    if (interrupter && interrupter->wasInterrupted(percent)) throw Interrupted();
    scan.image->read(z - whole.min().z(), count, bytes.data());
    detail::withSampleType(info.type, [&](auto type) {
      f(reinterpret_cast<const decltype(type)*>(bytes.data()), z, count);
    });
  }
}

}  // namespace

std::vector<GrayPlane> readGrayPlanes(GrayScan& scan, const CoordBBox& box,
                                      const std::vector<SlicePlane>& planes,
                                      Interrupter* interrupter) {
  placeScan(scan, box);
  std::vector<Samples> samples;
  bool needsAll = false;
  for (const SlicePlane& plane : planes) {
    const int width = box.dim()[plane.right()], height = box.dim()[plane.down()];
    samples.push_back({plane, width, height, std::vector<float>(size_t(width) * size_t(height))});
    needsAll |= plane.axis != 2;
  }
  const auto wanted = [&](int z, int count) {
    return needsAll || std::any_of(planes.begin(), planes.end(), [&](const auto& p) {
             return p.index >= z && p.index < z + count;
           });
  };
  const auto takeSlices = [&](const auto* slices, int z, int count) {
    take(slices, z, count, scan.box(), box, samples);
  };
  readSlices(scan, box.min().z(), box.max().z(), wanted, takeSlices, interrupter);
  std::vector<float> all;
  for (const Samples& plane : samples) addFinite(plane.values, all);
  const Contrast contrast(std::move(all));
  std::vector<GrayPlane> result;
  for (const Samples& plane : samples)
    result.push_back({plane.width, plane.height, shown(plane.values, contrast)});
  return result;
}

std::vector<uint8_t> readGrayBlocks(GrayScan& scan, const CoordBBox& blocks, int factor,
                                    Interrupter* interrupter) {
  const CoordBBox whole = scan.box();
  const size_t sliceSize = size_t(whole.dim().x()) * size_t(whole.dim().y());
  BlockMeans blockMeans(blocks, factor);
  const auto take = [&](const auto* slices, int z, int count) {
    for (int i = 0; i < count; ++i) blockMeans.add(slices + size_t(i) * sliceSize, z + i, whole);
  };
  readSlices(
      scan, std::max(whole.min().z(), blocks.min().z() * factor),
      std::min(whole.max().z(), (blocks.max().z() + 1) * factor - 1), [](int, int) { return true; },
      take, interrupter);
  const std::vector<float> means = blockMeans.result();
  std::vector<float> all;
  all.reserve(means.size());
  addFinite(means, all);
  const Contrast contrast(std::move(all));
  return shown(means, contrast);
}

}  // namespace vdb_madf
