// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/estimate_blur.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/intensity/detail/near_squares.h"
#include "vdb_madf/scans/histogram.h"
#include "vdb_madf/scans/image_box.h"

namespace vdb_madf {

namespace {

constexpr int kMiddleSide = 512, kMiddleSlices = 48;
constexpr int kFar = 5, kLeastFar = 3;    // voxels from an edge, and further ones are far
constexpr double kMostBlur = kFar / 2.0;  // wider edges reach beyond what is far
constexpr int64_t kFewestFar = 500;       // voxels of either material
constexpr double kSmoothing = 0.5;        // variance of (1 2 1)/4

/// The middle of an image, x fastest.
struct Middle {
  int nx = 0, ny = 0, nz = 0;
  std::vector<float> values;
  std::optional<double> corner;  // the one value at the corners of all slices

  size_t voxels() const { return values.size(); }
};

Middle readMiddle(ImageReader& image, Interrupter* interrupter) {
  const ImageSize& size = image.info().size;
  Middle middle;
  middle.nx = std::min(size.x, kMiddleSide);
  middle.ny = std::min(size.y, kMiddleSide);
  middle.nz = std::min(size.z, kMiddleSlices);
  middle.values.resize(size_t(middle.nx) * size_t(middle.ny) * size_t(middle.nz));
  const int x0 = (size.x - middle.nx) / 2, y0 = (size.y - middle.ny) / 2;
  const int z0 = (size.z - middle.nz) / 2;
  std::vector<char> slice(size_t(detail::sliceBytes(image.info())));
  bool cornersDiffer = false;
  float* to = middle.values.data();
  for (int z = 0; z < middle.nz; ++z) {
    if (interrupter && interrupter->wasInterrupted(z * 100 / middle.nz)) throw Interrupted();
    image.read(z0 + z, 1, slice.data());
    detail::withSampleType(image.info().type, [&](auto type) {
      const auto* samples = reinterpret_cast<const decltype(type)*>(slice.data());
      const size_t last = size_t(size.x) * size_t(size.y) - 1, row = size_t(size.x);
      for (const size_t place : {size_t(0), row - 1, last - row + 1, last}) {
        if (!middle.corner) middle.corner = double(samples[place]);
        cornersDiffer |= double(samples[place]) != *middle.corner;
      }
      for (int y = 0; y < middle.ny; ++y) {
        const auto* from = samples + size_t(y0 + y) * row + size_t(x0);
        to = std::transform(from, from + middle.nx, to, [](auto value) { return float(value); });
      }
    });
  }
  if (cornersDiffer) middle.corner.reset();
  return middle;
}

/// f(first, step, count) for each line of voxels along an axis.
template <typename F>
void forEachLine(const Middle& m, int axis, const F& f) {
  const size_t n[3] = {size_t(m.nx), size_t(m.ny), size_t(m.nz)};
  const size_t steps[3] = {1, n[0], n[0] * n[1]};
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  detail::parallelForEach(n[b], 1, nullptr, [&](size_t j) {
    for (size_t i = 0; i < n[a]; ++i) f(i * steps[a] + j * steps[b], steps[axis], n[axis]);
  });
}

/// (1 2 1)/4 along each axis; beyond the faces stands the mirror image.
std::vector<float> smoothed(const Middle& middle) {
  std::vector<float> values = middle.values;
  for (int axis = 0; axis < 3; ++axis)
    forEachLine(middle, axis, [&](size_t first, size_t step, size_t count) {
      float before = values[first];
      for (size_t i = 0; i < count; ++i) {
        float& value = values[first + i * step];
        const float here = value, after = i + 1 < count ? values[first + (i + 1) * step] : here;
        value = (before + 2 * here + after) / 4;
        before = here;
      }
    });
  return values;
}

/// Values that are there as an image; others are NaN.
class ValuesReader : public ImageReader {
 public:
  ValuesReader(const Middle& middle, const std::vector<float>& values) : values_(values) {
    info_.size = {middle.nx, middle.ny, middle.nz};
    info_.type = SampleType::float32;
  }
  void read(int first, int count, void* samples) override {
    const size_t slice = size_t(info_.size.x) * size_t(info_.size.y);
    std::copy_n(values_.begin() + std::ptrdiff_t(slice * size_t(first)), slice * size_t(count),
                static_cast<float*>(samples));
  }

 private:
  const std::vector<float>& values_;
};

/// The box of a domain in a scan, with NaN where the domain is not.
class DomainReader : public ImageReader {
 public:
  DomainReader(GrayScan scan, const Domain& domain)
      : scan_(std::move(scan)), domain_(domain), box_(domain.box()) {
    info_.size = toImageSize(box_.dim());
    info_.type = SampleType::float32;
    path_ = scan_.image->path();
    slice_.resize(size_t(detail::sliceBytes(scan_.image->info())));
    if (!domain.isBox()) region_.emplace(*domain_.region(), box_);
  }
  void read(int first, int count, void* samples) override {
    auto* to = static_cast<float*>(samples);
    for (int z = first; z < first + count; ++z, to += size_t(info_.size.x) * size_t(info_.size.y))
      readSlice(box_.min().z() + z, to);
  }

 private:
  void readSlice(int z, float* to) {
    const ImageInfo& whole = scan_.image->info();
    const Coord corner = box_.min() - scan_.first;
    const size_t nx = size_t(info_.size.x), ny = size_t(info_.size.y);
    scan_.image->read(z - scan_.first.z(), 1, slice_.data());
    detail::withSampleType(whole.type, [&](auto type) {
      const auto* samples = reinterpret_cast<const decltype(type)*>(slice_.data());
      for (size_t y = 0; y < ny; ++y) {
        const auto* from = samples + (size_t(corner.y()) + y) * size_t(whole.size.x) + corner.x();
        std::transform(from, from + nx, to + y * nx, [](auto value) { return float(value); });
      }
    });
    if (!region_) return;
    isInside_.resize(nx * ny);
    region_->read(z, 1, isInside_.data());
    for (size_t i = 0; i < isInside_.size(); ++i)
      if (!isInside_[i]) to[i] = NAN;
  }

  GrayScan scan_;
  const Domain domain_;
  const CoordBBox box_;
  std::vector<char> slice_;
  std::optional<detail::GridSlabs<MaskTree>> region_;
  std::vector<uint8_t> isInside_;
};

enum Material : uint8_t { pore, solid, absent };

constexpr int16_t kAbsent = -1;

/// Whether a place is within kFar of an end of a line of voxels, beyond which all is unknown. Of
/// lines that are hardly longer than that, none is.
bool nearEnd(int place, int count) {
  return count > 4 * kFar && (place < kFar || place >= count - kFar);
}

/// Squared distances to the nearest voxel of another material, up to kFar; kAbsent within that of
/// one that is absent or of a face of the middle.
std::vector<int16_t> edgeSquares(const Middle& middle, const std::vector<uint8_t>& materials) {
  std::vector<int16_t> nearest(middle.voxels(), (kFar + 1) * (kFar + 1));
  std::vector<uint8_t> isOfIt(middle.voxels());
  for (const uint8_t material : {pore, solid, absent}) {
    std::transform(materials.begin(), materials.end(), isOfIt.begin(),
                   [&](uint8_t m) { return uint8_t(m == material); });
    const std::vector<int16_t> squares = detail::nearSquares(
        {size_t(middle.nz), size_t(middle.ny), size_t(middle.nx)}, isOfIt, kFar);
    for (size_t i = 0; i < nearest.size(); ++i)
      if (material == absent && squares[i] <= kFar * kFar)
        nearest[i] = kAbsent;
      else if (materials[i] != material)
        nearest[i] = std::min(nearest[i], squares[i]);
  }
  size_t i = 0;
  for (int z = 0; z < middle.nz; ++z)
    for (int y = 0; y < middle.ny; ++y)
      for (int x = 0; x < middle.nx; ++x, ++i)
        if (nearEnd(x, middle.nx) || nearEnd(y, middle.ny) || nearEnd(z, middle.nz))
          nearest[i] = kAbsent;
  return nearest;
}

/// How far from edges voxels have to be so that there are enough of either material.
std::optional<int> farOf(const std::vector<uint8_t>& materials,
                         const std::vector<int16_t>& squares) {
  for (int far = kFar; far >= kLeastFar; --far) {
    int64_t voxels[2] = {0, 0};
    for (size_t i = 0; i < squares.size(); ++i)
      if (squares[i] > far * far) ++voxels[materials[i]];
    if (voxels[pore] >= kFewestFar && voxels[solid] >= kFewestFar) return far;
  }
  return std::nullopt;
}

/// Leaves out edges that others are near, such as those of grooves between grains: their voxels
/// become absent. Across a straight edge there are far voxels on both sides.
void keepStraight(const Middle& middle, const std::vector<uint8_t>& materials, int far,
                  std::vector<int16_t>& squares) {
  std::vector<double> across(middle.voxels(), 0);
  std::vector<uint8_t> isFar(middle.voxels());
  for (const uint8_t material : {pore, solid}) {
    for (size_t i = 0; i < squares.size(); ++i)
      isFar[i] = materials[i] == material && squares[i] > far * far;
    const std::vector<int16_t> toFar = detail::nearSquares(
        {size_t(middle.nz), size_t(middle.ny), size_t(middle.nx)}, isFar, 2 * far + 2);
    for (size_t i = 0; i < squares.size(); ++i) across[i] += std::sqrt(double(toFar[i]));
  }
  constexpr double kSlack = 1.5;  // of voxels that a straight edge passes anyhow
  for (size_t i = 0; i < squares.size(); ++i)
    if (squares[i] <= far * far && across[i] > 2 * far + kSlack) squares[i] = kAbsent;
}

/// Mean and variance of the values of some voxels.
struct Moments {
  int64_t count = 0;
  double sum = 0, squares = 0;

  void add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / double(count); }
  double variance() const { return squares / double(count) - mean() * mean(); }
};

/// Sum of f (1 - f) at the edges without what the noise adds to it.
double edgeSum(const std::vector<float>& values, const std::vector<uint8_t>& materials,
               const std::vector<int16_t>& squares, int far, ScanBlur& blur) {
  Moments plain[2];
  for (size_t i = 0; i < values.size(); ++i)
    if (squares[i] > far * far) plain[materials[i]].add(double(values[i]));
  blur.inside = plain[solid].mean();
  blur.outside = plain[pore].mean();
  const double contrast = blur.inside - blur.outside;
  const double variance =
      (plain[solid].variance() + plain[pore].variance()) / 2 / (contrast * contrast);
  blur.noise = std::sqrt(std::max(variance, 0.0));
  const auto [less, more] = std::minmax({plain[solid].variance(), plain[pore].variance()});
  if (less > 0) blur.unlike = std::sqrt(more / less);
  double sum = 0;
  for (size_t i = 0; i < values.size(); ++i)
    if (squares[i] >= 0 && squares[i] <= far * far) {
      const double f = (double(values[i]) - blur.outside) / contrast;
      sum += f * (1 - f) + variance;
    }
  return sum;
}

double partAtEnds(const std::vector<float>& values, const std::vector<uint8_t>& materials) {
  float least = std::numeric_limits<float>::infinity(), largest = -least;
  size_t count = 0, low = 0, high = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (materials[i] == absent) continue;
    ++count;
    if (values[i] < least) low = 0;
    if (values[i] > largest) high = 0;
    least = std::min(least, values[i]);
    largest = std::max(largest, values[i]);
    low += values[i] == least;
    high += values[i] == largest;
  }
  return double(std::max(low, high)) / double(count);
}

}  // namespace

std::optional<ScanBlur> estimateBlur(ImageReader& image, Interrupter* interrupter) {
  const Middle middle = readMiddle(image, interrupter);
  std::vector<float> smooth = smoothed(middle);
  for (size_t i = 0; i < smooth.size(); ++i)
    if (middle.corner && double(middle.values[i]) == *middle.corner) smooth[i] = NAN;
  ValuesReader reader(middle, smooth);
  const auto threshold = otsuThreshold(histogramOf(reader, interrupter));
  if (!threshold) return std::nullopt;
  std::vector<uint8_t> materials(smooth.size());
  for (size_t i = 0; i < smooth.size(); ++i)
    materials[i] = !std::isfinite(smooth[i]) ? absent : smooth[i] >= *threshold ? solid : pore;
  std::vector<int16_t> squares = edgeSquares(middle, materials);
  const auto far = farOf(materials, squares);
  if (!far) return std::nullopt;
  keepStraight(middle, materials, *far, squares);
  ScanBlur blur, afterwards;
  blur.atEnds = partAtEnds(middle.values, materials);
  const double sharper = edgeSum(middle.values, materials, squares, *far, blur);
  const double ratio = sharper / edgeSum(smooth, materials, squares, *far, afterwards);
  if (!(ratio > 0 && ratio < 1)) return std::nullopt;
  blur.sigma = std::sqrt(kSmoothing * ratio * ratio / (1 - ratio * ratio));
  if (blur.sigma > kMostBlur) return std::nullopt;
  return blur;
}

std::optional<ScanBlur> estimateBlur(GrayScan scan, const std::optional<Domain>& domain,
                                     Interrupter* interrupter) {
  if (domain) placeScan(scan, domain->box());
  if (!domain || *domain == Domain(scan.box())) return estimateBlur(*scan.image, interrupter);
  DomainReader part(std::move(scan), *domain);
  return estimateBlur(part, interrupter);
}

std::string noteOn(const ScanBlur& blur) {
  constexpr double kMuch = 0.05, kMostUnlike = 2;
  if (blur.atEnds >= kMuch)
    return fmt::format(
        "{:.0f} % of its values are the least or the largest that there are: if they were cut off, "
        "its blur, noise and necks come out wrong",
        100 * blur.atEnds);
  if (blur.unlike >= kMostUnlike)
    return fmt::format(
        "the values of one of its two materials spread {:.1f} times as far as those of the other: "
        "if that is two, noise and necks come out wrong",
        blur.unlike);
  return "";
}

ScanBlur blurOf(GrayScan scan, const std::optional<Domain>& domain, Interrupter* interrupter) {
  const std::string path = scan.image->path();
  if (const auto blur = estimateBlur(std::move(scan), domain, interrupter)) return *blur;
  throw InvalidInput(path +
                     ": its edges tell no blur: give the gray scan of two materials, in which "
                     "grains and pores are wider than 8 voxels");
}

}  // namespace vdb_madf
