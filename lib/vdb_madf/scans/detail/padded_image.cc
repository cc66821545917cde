// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/padded_image.h"

#include <algorithm>
#include <cmath>

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

void PaddedImage::read(int first, int count, void* samples) {
  image_.read(first, count, samples);
  const auto nx = size_t(info_.size.x), ny = size_t(info_.size.y);
  withSampleType(info_.type, [&](auto sample) {
    const auto* row = static_cast<const decltype(sample)*>(samples);
    if (!corner_) corner_ = double(row[0]);
    for (int z = first; z < first + count; ++z) {
      for (const size_t corner : {size_t(0), nx - 1, (ny - 1) * nx, ny * nx - 1})
        cornersDiffer_ |= !(double(row[corner]) == *corner_);
      for (int y = 0; y < info_.size.y; ++y, row += nx) {
        int begin = 0, end = info_.size.x;
        while (!cornersDiffer_ && begin < info_.size.x && double(row[begin]) == *corner_) ++begin;
        while (!cornersDiffer_ && end > 0 && double(row[end - 1]) == *corner_) --end;
        rows_[size_t(z % depth_) * ny + size_t(y)] = {begin, end};
        if (z >= box_.min().z() && z <= box_.max().z() &&
            (y == box_.min().y() || y == box_.max().y()))
          isAtCorners_ |= begin > box_.min().x() || end <= box_.max().x();
      }
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
