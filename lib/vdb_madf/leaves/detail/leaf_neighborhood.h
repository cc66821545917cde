// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstdint>

#include "vdb_madf/leaves/leaf_index.h"

namespace vdb_madf::detail {

/// The origin of the leaf at one of the 27 places around one, numbered as by LeafNeighborhood.
inline Coord around(const Coord& origin, int side) {
  return origin.offsetBy(8 * (side / 9 - 1), 8 * (side / 3 % 3 - 1), 8 * (side % 3 - 1));
}

/// The 27 leaves around each leaf of an index, diagonal ones too. Cheap if leaves are asked for in
/// rising order: shifting keeps the order of origins, so nine cursors walk along. One per thread.
class LeafNeighborhood {
 public:
  explicit LeafNeighborhood(const LeafIndex& index) : index_(&index) {}

  /// Entry (dx + 1) * 9 + (dy + 1) * 3 + dz + 1; LeafIndex::kNone where there is no leaf.
  const std::array<uint32_t, 27>& around(size_t leaf);

 private:
  const LeafIndex* index_;
  size_t last_ = ~size_t(0);
  std::array<size_t, 9> cursors_{};
  std::array<uint32_t, 27> found_{};
};

}  // namespace vdb_madf::detail
