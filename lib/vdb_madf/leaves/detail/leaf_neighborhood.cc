// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/leaves/detail/leaf_neighborhood.h"

namespace vdb_madf::detail {

namespace {

/// Up to so many leaves ahead, walking is quicker than bisection.
constexpr size_t kWalk = 32;

/// First leaf at or behind `origin`.
size_t lowerBound(const LeafIndex& index, const Coord& origin) {
  size_t first = 0, count = index.leafCount();
  while (count > 0) {
    const size_t half = count / 2;
    if (index.origin(first + half) < origin) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

}  // namespace

const std::array<uint32_t, 27>& LeafNeighborhood::around(size_t leaf) {
  if (leaf == last_) return found_;
  const LeafIndex& index = *index_;
  const bool ahead = last_ != ~size_t(0) && leaf >= last_ && leaf - last_ < kWalk;
  for (int column = 0; column < 9; ++column) {
    const Coord first = index.origin(leaf).offsetBy(8 * (column / 3 - 1), 8 * (column % 3 - 1), -8);
    size_t& cursor = cursors_[size_t(column)];
    if (!ahead) cursor = lowerBound(index, first);
    while (cursor < index.leafCount() && index.origin(cursor) < first) ++cursor;
    size_t at = cursor;
    for (int dz = 0; dz < 3; ++dz) {
      const bool here = at < index.leafCount() && index.origin(at) == first.offsetBy(0, 0, 8 * dz);
      found_[size_t(column * 3 + dz)] = here ? uint32_t(at++) : LeafIndex::kNone;
    }
  }
  last_ = leaf;
  return found_;
}

}  // namespace vdb_madf::detail
