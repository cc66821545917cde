// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/volumes/dense_volume.h"

#include <string>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/base/limits.h"
#include "vdb_madf/grids/detail/grid_slabs.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"
#include "vdb_madf/scans/detail/mask_packer.h"
#include "vdb_madf/volumes/detail/label_packer.h"
#include "vdb_madf/volumes/detail/sample_slabs.h"

namespace vdb_madf {

namespace {

constexpr char kName[] = "the array";  // in messages, where an image has its path
constexpr size_t kRowsPerChunk = 16;

void check(const DenseLayout& layout) {
  if (layout.box.empty()) throw InvalidInput("the array has no voxels");
  for (int axis = 0; axis < 3; ++axis)
    if (layout.box.min()[axis] < -kMaxCoordinate || layout.box.max()[axis] > kMaxCoordinate)
      throw InvalidInput("the box of the array reaches beyond the coordinate " +
                         std::to_string(kMaxCoordinate));
}

/// Where the samples of a box lie.
class Places {
 public:
  explicit Places(const DenseLayout& layout)
      : box_(layout.box), size_(layout.box.dim()), strides_(packed()) {
    if (layout.strides) strides_ = *layout.strides;
  }

  bool arePacked() const { return strides_ == packed(); }
  int64_t slice(int z) const { return (int64_t(z) - box_.min().z()) * strides_[2]; }

  /// f(place in the array, place in a packed slab, samples along x) for the rows of a slab, in
  /// parallel.
  template <typename F>
  void forEachRow(int z, int count, const F& f) const {
    const size_t ny = size_t(size_.y()), nx = size_t(size_.x());
    detail::parallelForEach(ny * size_t(count), kRowsPerChunk, nullptr, [&](size_t row) {
      f(slice(z + int(row / ny)) + int64_t(row % ny) * strides_[1], row * nx);
    });
  }
  int64_t alongX() const { return strides_[0]; }
  size_t nx() const { return size_t(size_.x()); }

 private:
  std::array<int64_t, 3> packed() const { return {1, size_.x(), int64_t(size_.x()) * size_.y()}; }

  CoordBBox box_;
  Coord size_;
  std::array<int64_t, 3> strides_;
};

/// f(slab, samples) with the samples packed: x fastest, without gaps.
template <typename F>
void forEachPackedSlab(const void* samples, const DenseLayout& layout, Interrupter* interrupter,
                       const F& f) {
  check(layout);
  const CoordBBox& box = layout.box;
  const Places places(layout);
  detail::withSampleType(layout.type, [&](auto sample) {
    using Sample = decltype(sample);
    const auto* from = static_cast<const Sample*>(samples);
    std::vector<Sample> buffer;
    detail::forEachSlab(box.min().z(), box.max().z() + 1, interrupter, [&](int z, int count) {
      const CoordBBox slab = detail::slicesOf(box, z, count);
      if (places.arePacked()) return f(slab, static_cast<const void*>(from + places.slice(z)));
      buffer.resize(slab.volume());
      places.forEachRow(z, count, [&](int64_t place, size_t packed) {
        for (size_t x = 0; x < places.nx(); ++x)
          buffer[packed + x] = from[place + int64_t(x) * places.alongX()];
      });
      f(slab, static_cast<const void*>(buffer.data()));
    });
  });
}

}  // namespace

MaskGrid::Ptr maskFromDense(const void* samples, const DenseLayout& layout,
                            const Selection& selection, const std::optional<VoxelSize>& voxelSize,
                            Interrupter* interrupter) {
  const auto grid = MaskGrid::create();
  forEachPackedSlab(samples, layout, interrupter, [&](const CoordBBox& slab, const void* packed) {
    detail::packMask(packed, layout.type, slab, selection, grid->tree());
  });
  grid->setName("object");
  setDomain(*grid, layout.box);
  setVoxelSize(*grid, voxelSize);
  return grid;
}

Int32Grid::Ptr labelsFromDense(const void* samples, const DenseLayout& layout,
                               const std::optional<VoxelSize>& voxelSize,
                               Interrupter* interrupter) {
  const auto grid = Int32Grid::create(0);
  forEachPackedSlab(samples, layout, interrupter, [&](const CoordBBox& slab, const void* packed) {
    detail::packLabels(kName, packed, layout.type, slab, grid->tree());
  });
  setDomain(*grid, layout.box);
  setVoxelSize(*grid, voxelSize);
  return grid;
}

void copyToDense(const openvdb::GridBase& grid, void* samples, const DenseLayout& layout,
                 Interrupter* interrupter) {
  check(layout);
  detail::requireNumbers(kName, grid);
  const Places places(layout);
  detail::forEachSampleSlab(kName, grid, layout.box, layout.type, interrupter,
                            [&](int z, int count, const void* slab) {
                              detail::withSampleType(layout.type, [&](auto sample) {
                                const auto* from = static_cast<const decltype(sample)*>(slab);
                                auto* to = static_cast<decltype(sample)*>(samples);
                                places.forEachRow(z, count, [&](int64_t place, size_t packed) {
                                  for (size_t x = 0; x < places.nx(); ++x)
                                    to[place + int64_t(x) * places.alongX()] = from[packed + x];
                                });
                              });
                            });
}

}  // namespace vdb_madf
