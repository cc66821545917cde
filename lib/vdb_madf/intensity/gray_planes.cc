// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/intensity/gray_planes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

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

std::string sizeText(const CoordBBox& box) {
  return fmt::format("{}x{}x{} voxels", box.dim().x(), box.dim().y(), box.dim().z());
}

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

std::vector<GrayPlane> withContrast(const std::vector<Samples>& planes) {
  std::vector<float> all;
  for (const Samples& plane : planes)
    for (const float value : plane.values)
      if (std::isfinite(value)) all.push_back(value);
  float low = 0, high = 1;
  if (!all.empty()) {
    const auto clipped = std::ptrdiff_t(kClipped * double(all.size()));
    std::nth_element(all.begin(), all.begin() + clipped, all.end());
    low = all[size_t(clipped)];
    std::nth_element(all.begin(), all.end() - 1 - clipped, all.end());
    high = all[all.size() - 1 - size_t(clipped)];
  }
  const double range = double(high) - double(low);
  std::vector<GrayPlane> result;
  for (const Samples& plane : planes) {
    GrayPlane gray{plane.width, plane.height, {}};
    for (const float value : plane.values) {
      const double share = range > 0 ? (double(value) - double(low)) / range : 0.5;
      gray.values.push_back(std::isfinite(value)
                                ? uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0)))
                                : uint8_t(0));
    }
    result.push_back(std::move(gray));
  }
  return result;
}

}  // namespace

std::vector<GrayPlane> readGrayPlanes(GrayScan& scan, const CoordBBox& box,
                                      const std::vector<SlicePlane>& planes,
                                      Interrupter* interrupter) {
  const CoordBBox whole = scan.box();
  if (!whole.isInside(box))
    throw InvalidInput(scan.image->path() + ": has " + sizeText(whole) +
                       ", and the labels are those of a scan of " + sizeText(box) +
                       ": give the one that they were made of, cropped as they were");
  std::vector<Samples> samples;
  bool needsAll = false;
  for (const SlicePlane& plane : planes) {
    const int width = box.dim()[plane.right()], height = box.dim()[plane.down()];
    samples.push_back({plane, width, height, std::vector<float>(size_t(width) * size_t(height))});
    needsAll |= plane.axis != 2;
  }
  const ImageInfo& info = scan.image->info();
  std::vector<char> bytes(size_t(detail::sliceBytes(info)) *
                          size_t(std::min(kSlices, whole.dim().z())));
  for (int z = box.min().z(); z <= box.max().z(); z += kSlices) {
    const int count = std::min(kSlices, box.max().z() - z + 1);
    const bool wanted = needsAll || std::any_of(planes.begin(), planes.end(), [&](const auto& p) {
                          return p.index >= z && p.index < z + count;
                        });
    if (!wanted) continue;
    const int percent = int(int64_t(z - box.min().z()) * 100 / box.dim().z());
    if (interrupter && interrupter->wasInterrupted(percent)) throw Interrupted();
    scan.image->read(z - whole.min().z(), count, bytes.data());
    detail::withSampleType(info.type, [&](auto type) {
      take(reinterpret_cast<const decltype(type)*>(bytes.data()), z, count, whole, box, samples);
    });
  }
  return withContrast(samples);
}

}  // namespace vdb_madf
