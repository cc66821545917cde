// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/padded_image.h"

#include <algorithm>
#include <cmath>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/image_box.h"

namespace vdb_madf::detail {

PaddedImage::PaddedImage(ImageReader& image, int reach, const CoordBBox& box)
    : image_(image), reach_(reach), depth_(2 * reach + kSlab), box_(box) {
  info_ = image.info();
  path_ = image.path();
  files_ = image.files();
  box_.intersect(imageBox(info_.size));
  rows_.resize(size_t(depth_) * size_t(info_.size.y));
}

namespace {

constexpr size_t kRowGrain = 256;  // of a slab

/// So many at the front have the value. Whole blocks are looked at without a way out of them, which
/// takes a fraction of the time.
template <typename HasValue>
int runLength(int count, const HasValue& hasValue) {
  constexpr int kBlock = 64;
  int run = 0;
  for (bool all = true; all && run + kBlock <= count; run += all ? kBlock : 0)
    for (int i = run; i < run + kBlock; ++i) all &= hasValue(i);
  while (run < count && hasValue(run)) ++run;
  return run;
}

}  // namespace

void PaddedImage::read(int first, int count, void* samples) {
  image_.read(first, count, samples);
  const auto nx = size_t(info_.size.x), ny = size_t(info_.size.y);
  withSampleType(info_.type, [&](auto sample) {
    using Sample = decltype(sample);
    const auto* const rows = static_cast<const Sample*>(samples);
    if (!corner_) corner_ = double(rows[0]);
    for (size_t z = 0; z < size_t(count); ++z)
      for (const size_t corner : {size_t(0), nx - 1, (ny - 1) * nx, ny * nx - 1})
        cornersDiffer_ |= !(double(rows[z * ny * nx + corner]) == *corner_);
    if (cornersDiffer_) return;
    parallelForEach(size_t(count) * ny, kRowGrain, nullptr, [&](size_t n) {
      const Sample* const row = rows + n * nx;
      const int size = info_.size.x;
      const int begin = runLength(size, [row, value = rows[0]](int i) { return row[i] == value; });
      const int rest = begin == size ? size : runLength(size, [&, value = rows[0]](int i) {
        return row[size - 1 - i] == value;
      });
      rows_[size_t(first + int(n / ny)) % size_t(depth_) * ny + n % ny] = {begin, size - rest};
    });
    if (box_.empty()) return;
    for (int z = std::max(first, box_.min().z()); z <= std::min(first + count - 1, box_.max().z());
         ++z)
      for (const int y : {box_.min().y(), box_.max().y()}) {
        const auto [begin, end] = within(y, z);
        isAtCorners_ |= begin > box_.min().x() || end <= box_.max().x();
      }
  });
}

std::optional<double> PaddedImage::corner() const {
  return cornersDiffer_ || !corner_ || !std::isfinite(*corner_) ? std::nullopt : corner_;
}

std::pair<int, int> PaddedImage::apart(int y, int z) const {
  std::pair<int, int> row(0, info_.size.x);
  if (cornersDiffer_) return row;
  for (int k = std::max(z - reach_, 0); k <= std::min(z + reach_, info_.size.z - 1); ++k)
    for (int j = std::max(y - reach_, 0); j <= std::min(y + reach_, info_.size.y - 1); ++j) {
      const auto [begin, end] = within(j, k);
      if (begin > 0) row.first = std::max(row.first, begin + reach_);
      if (end < info_.size.x) row.second = std::min(row.second, end - reach_);
    }
  return row;
}

}  // namespace vdb_madf::detail
