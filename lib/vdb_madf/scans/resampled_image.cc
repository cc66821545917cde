// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/resampled_image.h"

#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/cubes_along.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/images/detail/header_checks.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/scans/detail/slice_window.h"

namespace vdb_madf {

namespace {

constexpr size_t kResampledRowsPerChunk = 16;

/// Between which voxels the center of a cube lies.
struct Place {
  int lower;
  double beyond;  ///< of the way to the next; 0: the lower voxel alone counts
};

std::vector<Place> placesAlong(int voxels, double voxelEdge, double cubeEdge) {
  const detail::CubesAlong along(voxelEdge, cubeEdge);
  std::vector<Place> places(size_t(along.countFor(voxels)));
  for (size_t j = 0; j < places.size(); ++j) {
    // From the center of voxel 0, in half lengths.
    const int64_t way = (2 * int64_t(j) + 1) * along.cubeEdge() - along.voxelEdge(),
                  step = 2 * along.voxelEdge();
    if (way < 0)
      places[j] = {0, 0};
    else if (way / step >= voxels - 1)
      places[j] = {voxels - 1, 0};
    else
      places[j] = {int(way / step), double(way % step) / double(step)};
  }
  return places;
}

double between(double lower, double upper, double beyond) {
  return lower + beyond * (upper - lower);
}

template <typename T>
T rounded(double value) {
  if constexpr (std::is_integral_v<T>)
    return T(std::floor(value + 0.5));
  else
    return T(value);
}

template <typename T>
class ResampledImage : public ImageReader {
 public:
  ResampledImage(std::unique_ptr<ImageReader> image, const VoxelSize& voxels, double edge)
      : image_(std::move(image)), window_(*image_, 0) {
    info_ = image_->info();
    path_ = image_->path();
    files_ = image_->files();
    for (int axis = 0; axis < 3; ++axis) {
      places_[axis] = placesAlong(info_.size[axis], voxels.edges()[size_t(axis)], edge);
      info_.size[axis] = int(places_[axis].size());
    }
    info_.voxelSize = VoxelSize(edge);
    info_.proportions.reset();
    const double slice = double(info_.size.x) * info_.size.y;
    detail::checkCubes(slice * info_.size.z, 2 * slice * std::min(info_.size.z, 8) * sizeof(T));
  }

  void read(int first, int count, void* samples) override {
    detail::checkSlices(path_, info_, first, count);
    auto* to = static_cast<T*>(samples);
    for (int z = first; z < first + count; ++z, to += size_t(info_.size.x) * size_t(info_.size.y))
      readSlice(places_[2][size_t(z)], to);
  }

 private:
  void readSlice(const Place& z, T* to) {
    window_.moveTo(z.lower, z.beyond > 0 ? 2 : 1);
    detail::parallelFor(
        size_t(info_.size.y), kResampledRowsPerChunk, nullptr, [&](size_t begin, size_t end) {
          std::vector<double> row(size_t(image_->info().size.x));
          for (size_t y = begin; y < end; ++y) {
            fillRow(places_[1][y], z, row);
            T* const sample = to + y * size_t(info_.size.x);
            for (size_t x = 0; x < size_t(info_.size.x); ++x) {
              const auto& [lower, beyond] = places_[0][x];
              const double* const value = &row[size_t(lower)];
              sample[x] = rounded<T>(beyond > 0 ? between(value[0], value[1], beyond) : value[0]);
            }
          }
        });
  }

  /// The values at the place of a row of cubes, where voxels are along x.
  void fillRow(const Place& y, const Place& z, std::vector<double>& row) const {
    const auto inSlice = [&](int slice, size_t x) {
      const double value = double(window_.row(y.lower, slice)[x]);
      return y.beyond > 0 ? between(value, double(window_.row(y.lower + 1, slice)[x]), y.beyond)
                          : value;
    };
    for (size_t x = 0; x < row.size(); ++x) {
      row[x] = inSlice(z.lower, x);
      if (z.beyond > 0) row[x] = between(row[x], inSlice(z.lower + 1, x), z.beyond);
    }
  }

  std::unique_ptr<ImageReader> image_;
  detail::SliceWindow<T> window_;
  std::vector<Place> places_[3];
};

}  // namespace

std::unique_ptr<ImageReader> resampledImage(std::unique_ptr<ImageReader> image,
                                            const VoxelSize& voxels, double edge) {
  std::unique_ptr<ImageReader> resampled;
  detail::withSampleType(image->info().type, [&](auto sample) {
    resampled = std::make_unique<ResampledImage<decltype(sample)>>(std::move(image), voxels, edge);
  });
  return resampled;
}

std::array<double, 3> resampledOrigin(const VoxelSize& voxels, double edge) {
  std::array<double, 3> origin{};
  for (size_t axis = 0; axis < 3; ++axis) origin[axis] = 1e3 * (edge - voxels.edges()[axis]) / 2;
  return origin;
}

}  // namespace vdb_madf
