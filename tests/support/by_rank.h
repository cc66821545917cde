// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <stdexcept>

#include "support/dense_volume.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/leaves/voxel_array.h"

/// From the dense volumes that tests draw to the arrays that the stages work on, and back.
namespace vdb_madf::test {

/// f(id) for the object voxels, ascending.
template <typename F>
void forEachId(const LeafIndex& index, const F& f) {
  for (VoxelId id = 0; id < index.leafCount() * 512; ++id)
    if (index.mask(leafOf(id))[wordOf(id)] >> bitOf(id) & 1) f(id);
}

/// The id of a voxel of one of the leaves.
inline VoxelId idOf(const LeafIndex& index, const Coord& p) {
  const Coord origin = p & ~7;
  size_t first = 0, last = index.leafCount();
  while (last - first > 1) {
    const size_t middle = (first + last) / 2;
    (origin < index.origin(middle) ? last : first) = middle;
  }
  if (first == last || index.origin(first) != origin)
    throw std::logic_error("no leaf at " + toString(p));
  return VoxelId(first * 512 + size_t((p.x() & 7) * 64 + (p.y() & 7) * 8 + (p.z() & 7)));
}

/// valueAt(coord) of the object voxels.
template <typename T, typename ValueAt>
VoxelArray<T> byRank(const LeafIndex& index, const ValueAt& valueAt) {
  VoxelArray<T> array(size_t(index.voxelCount()));
  forEachId(index, [&](VoxelId id) { array[index.rank(id)] = T(valueAt(index.coord(id))); });
  return array;
}
/// The volume's values there.
template <typename T, typename Value>
VoxelArray<T> byRank(const LeafIndex& index, const DenseVolume<Value>& values) {
  return byRank<T>(index, [&](const Coord& p) { return values[p]; });
}

/// Values of the array on the object's voxels, 0 elsewhere in the box.
template <typename T>
DenseVolume<int64_t> dense(const LeafIndex& index, const VoxelArray<T>& array,
                           const CoordBBox& box) {
  if (array.size() != size_t(index.voxelCount())) throw std::logic_error("not a value per voxel");
  DenseVolume<int64_t> result(box);
  forEachId(index, [&](VoxelId id) { result[index.coord(id)] = array[index.rank(id)]; });
  return result;
}

}  // namespace vdb_madf::test
