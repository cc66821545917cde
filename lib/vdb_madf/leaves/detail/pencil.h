// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// Pencils per task: a pencil of a few leaves costs some tens of microseconds.
constexpr size_t kPencilGrain = 8;

/// First leaves of the pencils along an axis: the leaves without a neighbor before them.
inline std::vector<uint32_t> pencilStarts(const LeafIndex& index, int axis) {
  std::vector<uint32_t> starts;
  for (size_t i = 0; i < index.leafCount(); ++i)
    if (index.neighbors(i)[2 * axis] == LeafIndex::kNone) starts.push_back(uint32_t(i));
  return starts;
}

/// The leaves that follow each other without a gap along an axis, from `start` on.
inline void collectPencil(const LeafIndex& index, int axis, uint32_t start,
                          std::vector<uint32_t>& leaves) {
  leaves.clear();
  for (uint32_t i = start; i != LeafIndex::kNone; i = index.neighbors(i)[2 * axis + 1])
    leaves.push_back(i);
}

/// The 64 rows of a pencil are numbered by the other two coordinates, the slower one first. Offsets
/// within a leaf (x*64 + y*8 + z) of the voxel at position t (0..7) of a row:
template <int Axis>
constexpr int rowOffset(int row) {
  if (Axis == 0) return row;                          // row = y*8 + z
  if (Axis == 1) return (row >> 3) * 64 + (row & 7);  // row = x*8 + z
  return row * 8;                                     // row = x*8 + y
}
template <int Axis>
constexpr int rowStride() {
  return Axis == 0 ? 64 : Axis == 1 ? 8 : 1;
}

/// Copies between the 512 voxels of a leaf and its 8 slabs: a slab holds the 64 rows at one
/// position, `pitch` values before the next.
template <int Axis, typename Dense, typename Slab>
[[gnu::always_inline]] inline void copyToSlabs(const Dense* dense, size_t pitch, Slab* slab) {
  for (size_t t = 0; t < 8; ++t)
    for (int row = 0; row < 64; ++row)
      slab[t * pitch + size_t(row)] =
          Slab(dense[rowOffset<Axis>(row) + int(t) * rowStride<Axis>()]);
}
template <int Axis, typename Slab, typename Dense>
[[gnu::always_inline]] inline void copyFromSlabs(const Slab* slab, size_t pitch, Dense* dense) {
  for (size_t t = 0; t < 8; ++t)
    for (int row = 0; row < 64; ++row)
      dense[rowOffset<Axis>(row) + int(t) * rowStride<Axis>()] =
          Dense(slab[t * pitch + size_t(row)]);
}

}  // namespace vdb_madf::detail
