// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/squared_distance.h"

// What the sweeps need to know of the volume beyond a slab: a part [begin, end) along z of it, with
// cuts on the leaf grid.

namespace vdb_madf::detail {

/// How many object voxels follow each other in the columns beyond a cut, from the cut on, until
/// background; kInfinite (distance_rows.h) if unknown voxels come first.
class ColumnSteps {
 public:
  using Rows = std::array<uint32_t, 64>;  ///< of the columns of a leaf, x*8 + y

  ColumnSteps() = default;
  ColumnSteps(std::vector<std::array<int, 2>> leaves, std::vector<Rows> rows)
      : leaves_(std::move(leaves)), rows_(std::move(rows)) {}
  /// Adds the columns that the leaf at `origin` stands in; by ascending origins in one plane.
  void add(const Coord& origin, const Rows& rows) {
    leaves_.push_back({origin.x(), origin.y()});
    rows_.push_back(rows);
  }
  /// 0 where there is no leaf.
  Rows of(const Coord& origin) const {
    const std::array<int, 2> leaf{origin.x(), origin.y()};
    const auto found = std::lower_bound(leaves_.begin(), leaves_.end(), leaf);
    if (found == leaves_.end() || *found != leaf) return {};
    return rows_[size_t(found - leaves_.begin())];
  }

  const std::vector<std::array<int, 2>>& leaves() const { return leaves_; }
  const std::vector<Rows>& rows() const { return rows_; }

 private:
  std::vector<std::array<int, 2>> leaves_;
  std::vector<Rows> rows_;
};

/// Does a layer lie outside of an open domain, which is a box?
inline bool isUnknown(const Obstacles& obstacles, int z) {
  const CoordBBox& box = obstacles.domain.box();
  return obstacles.open && (z < box.min().z() || z > box.max().z());
}

/// A slab among others: begin <= z < end, both multiples of 8.
struct SlabFaces {
  int begin = 0, end = 0;
  ColumnSteps below, above;
  bool hasBelow = false, hasAbove = false;  ///< is there a slab?
};

/// Distances in a slab of an object that goes on beyond it; the passes go along z, x, y.
/// @throw as squaredDistance(); InvalidInput if a distance is 46341 voxels or more.
SquaredDistance squaredDistanceInSlab(const LeafIndex& index, const Obstacles& obstacles,
                                      const VoxelWeights& weights, const SlabFaces& faces,
                                      Interrupter* interrupter);

}  // namespace vdb_madf::detail
