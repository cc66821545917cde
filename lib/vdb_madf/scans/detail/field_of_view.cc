// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/detail/field_of_view.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/active_tiles.h"
#include "vdb_madf/images/detail/sample_conversion.h"
#include "vdb_madf/images/detail/slabs.h"

namespace vdb_madf::detail {

namespace {

constexpr size_t kRowsOfView = 16;

/// The first and the last of a line of voxels.
struct Ends {
  int first = std::numeric_limits<int>::max(), last = -1;
  void add(int low, int high) {
    first = std::min(first, low);
    last = std::max(last, high);
  }
};

/// The ends of rows, of each y along z, else of each z: of the voxels whose value differs from the
/// first one's, and of those that are not 0. Which of the two are the field of view is known when
/// the last corner was seen.
struct Rims {
  std::vector<Ends> notFirst, notZero;

  /// Between the first and the last such voxel of a row none is farther away.
  template <typename T>
  static Ends ofRow(const T* row, int length, T outside) {
    const auto isSeen = [&](int x) { return row[x] == row[x] && row[x] != outside; };
    Ends ends;
    int first = 0, last = length - 1;
    while (first < length && !isSeen(first)) ++first;
    if (first == length) return ends;
    while (!isSeen(last)) --last;
    ends.add(first, last);
    return ends;
  }
};

template <typename T>
std::vector<PlanePoint> rimOf(ImageReader& image, int axis, Interrupter* interrupter) {
  const ImageSize size = image.info().size;
  const auto nx = size_t(size.x), ny = size_t(size.y);
  const auto lines = size_t(axis == 2 ? size.y : size.z);
  std::vector<T> samples(nx * ny * size_t(std::min(kSlab, size.z)));
  std::optional<T> first;
  bool sameCorners = true;
  PerThread<Rims> partial;
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
      Rims& rims = partial.local();
      rims.notFirst.resize(lines);
      rims.notZero.resize(lines);
      for (size_t row = begin; row < end; ++row) {
        const size_t y = row % ny, line = axis == 2 ? y : size_t(z) + row / ny;
        const T* const values = &samples[row * nx];
        for (auto& [ends, outside] :
             {std::pair(&rims.notFirst[line], *first), std::pair(&rims.notZero[line], T(0))}) {
          const Ends found = Rims::ofRow(values, size.x, outside);
          if (found.last >= 0 && axis == 0) ends->add(int(y), int(y));
          if (found.last >= 0 && axis != 0) ends->add(found.first, found.last);
        }
      }
    });
  });
  std::vector<Ends> all(lines);
  for (const Rims& rims : partial) {
    const std::vector<Ends>& some = sameCorners ? rims.notFirst : rims.notZero;
    for (size_t line = 0; line < some.size(); ++line)
      if (some[line].last >= 0) all[line].add(some[line].first, some[line].last);
  }
  // In one order, whatever the threads had: the least circle depends on it in its last bits.
  std::vector<PlanePoint> rim;
  for (size_t line = 0; line < lines; ++line)
    if (all[line].last >= 0)
      for (const int end : {all[line].first, all[line].last})
        rim.push_back({{double(end), double(line)}});
  return rim;
}

}  // namespace

std::vector<PlanePoint> rimOfView(ImageReader& image, int axis, Interrupter* interrupter) {
  return withSampleType(image.info().type, [&](auto sample) {
    return rimOf<decltype(sample)>(image, axis, interrupter);
  });
}

double farthestFromAxis(const std::vector<PlanePoint>& rim, const CylinderAxis& axis) {
  double result = -1;
  for (const PlanePoint& p : rim) result = std::max(result, Circle{axis.center}.squaredDistance(p));
  return result;
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
