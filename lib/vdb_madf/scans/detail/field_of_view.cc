// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/field_of_view.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kRowsOfView = 16;

/// Of the voxels whose value differs from the first one's, and of those that are not 0: which of
/// the two are the field of view is known when the last corner was seen.
struct Farthest {
  double notFirst = -1, notZero = -1;

  /// Of a row the first and the last such voxel count: in between the distance is smaller.
  template <typename T>
  static double ofRow(const T* row, int length, T outside, Coord p, const CylinderAxis& axis) {
    const auto isSeen = [&](int x) { return row[x] == row[x] && row[x] != outside; };
    int first = 0, last = length - 1;
    while (first < length && !isSeen(first)) ++first;
    if (first == length) return -1;
    while (!isSeen(last)) --last;
    p.x() = first;
    const double atFirst = axis.squaredDistance(p);
    p.x() = last;
    return std::max(atFirst, axis.squaredDistance(p));
  }
};

template <typename T>
double farthestSample(ImageReader& image, const CylinderAxis& axis, Interrupter* interrupter) {
  const ImageSize size = image.info().size;
  const auto nx = size_t(size.x), ny = size_t(size.y);
  std::vector<T> samples(nx * ny * size_t(std::min(kSlab, size.z)));
  std::optional<T> first;
  bool sameCorners = true;
  PerThread<Farthest> partial;
  forEachSlab(0, size.z, interrupter, [&](int z, int count) {
    image.read(z, count, samples.data());
    if (!first) first = samples[0];
    for (const int end : {0, size.z - 1}) {
      if (end < z || end >= z + count) continue;
      const T* const slice = &samples[size_t(end - z) * nx * ny];
      for (const size_t corner : {size_t(0), nx - 1, (ny - 1) * nx, ny * nx - 1})
        sameCorners &=
            slice[corner] == *first || (*first != *first && slice[corner] != slice[corner]);
    }
    parallelFor(ny * size_t(count), kRowsOfView, nullptr, [&](size_t begin, size_t end) {
      Farthest& farthest = partial.local();
      for (size_t row = begin; row < end; ++row) {
        const Coord p(0, int(row % ny), z + int(row / ny));
        const T* const values = &samples[row * nx];
        farthest.notFirst =
            std::max(farthest.notFirst, Farthest::ofRow(values, size.x, *first, p, axis));
        farthest.notZero =
            std::max(farthest.notZero, Farthest::ofRow(values, size.x, T(0), p, axis));
      }
    });
  });
  double result = -1;
  for (const Farthest& farthest : partial)
    result = std::max(result, sameCorners ? farthest.notFirst : farthest.notZero);
  return result;
}

}  // namespace

double farthestFromAxis(ImageReader& image, const CylinderAxis& axis, Interrupter* interrupter) {
  return withSampleType(image.info().type, [&](auto sample) {
    return farthestSample<decltype(sample)>(image, axis, interrupter);
  });
}

double farthestFromAxis(const MaskTree& tree, const CylinderAxis& axis) {
  double result = -1;
  forEachActiveTile(tree,
                    [&](const CoordBBox& box) { result = std::max(result, axis.farthest(box)); });
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    if (axis.farthest(leaf->getNodeBoundingBox()) <= result) continue;
    for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel)
      result = std::max(result, axis.squaredDistance(voxel.getCoord()));
  }
  return result;
}

}  // namespace vdb_madf::detail
