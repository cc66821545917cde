// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/column_steps.h"

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/kernels/distance_rows.h"

namespace vdb_madf::detail {

namespace {

/// The walk from one cut of a slab towards the other, in the columns of a leaf.
class Walk {
 public:
  Walk(const LeafIndex& index, const Obstacles& obstacles, const SlabFaces& faces, bool above)
      : index_(index), obstacles_(obstacles), faces_(faces), step_(above ? 1 : -1) {}

  ColumnSteps::Rows from(uint32_t leaf) {
    steps_.fill(0);
    const size_t side = step_ > 0 ? 5 : 4;
    going_ = ~uint64_t(0);
    for (uint32_t next = leaf; going_; leaf = next) {
      const auto layers = layersAlongZ(index_.mask(leaf));
      for (int i = 0; i < 8; ++i) {
        const int t = step_ > 0 ? i : 7 - i;
        stop(going_ & ~layers[size_t(t)], index_.origin(leaf).z() + t);
        forEachBit(going_, [&](int row) { ++steps_[size_t(row)]; });
      }
      next = index_.neighbors(leaf)[side];
      if (next == LeafIndex::kNone) break;
    }
    if (going_) leave(index_.origin(leaf));
    return steps_;
  }

 private:
  /// In these rows z is the first that is no object.
  void stop(uint64_t rows, int z) {
    going_ &= ~rows;
    if (isUnknown(obstacles_, z))
      forEachBit(rows, [&](int row) { steps_[size_t(row)] = kInfinite; });
  }

  /// Beyond the last leaf of the walk.
  void leave(const Coord& origin) {
    const int z = step_ > 0 ? origin.z() + 8 : origin.z() - 1;
    const bool atCut =
        step_ > 0 ? faces_.hasAbove && z == faces_.end : faces_.hasBelow && z == faces_.begin - 1;
    if (!atCut || isUnknown(obstacles_, z)) {
      stop(going_, z);
      return;
    }
    forEachBit(going_, [&](int row) { steps_[size_t(row)] = kThrough; });
  }

  const LeafIndex& index_;
  const Obstacles& obstacles_;
  const SlabFaces& faces_;
  int step_;
  uint64_t going_ = 0;
  ColumnSteps::Rows steps_{};
};

}  // namespace

ColumnSteps columnSteps(const LeafIndex& index, const Obstacles& obstacles, const SlabFaces& faces,
                        bool above) {
  ColumnSteps result;
  Walk walk(index, obstacles, faces, above);
  const int z = above ? faces.begin : faces.end - 8;
  for (uint32_t leaf = 0; leaf < index.leafCount(); ++leaf)
    if (index.origin(leaf).z() == z) result.add(index.origin(leaf), walk.from(leaf));
  return result;
}

ColumnSteps passOn(const ColumnSteps& own, const ColumnSteps& beyond, int height) {
  ColumnSteps result;
  for (size_t i = 0; i < own.leaves().size(); ++i) {
    const Coord origin(own.leaves()[i][0], own.leaves()[i][1], 0);
    ColumnSteps::Rows rows = own.rows()[i];
    const ColumnSteps::Rows further = beyond.of(origin);
    for (size_t row = 0; row < 64; ++row)
      if (rows[row] == kThrough)
        rows[row] = further[row] == kInfinite ? kInfinite : uint32_t(height) + further[row];
    result.add(origin, rows);
  }
  return result;
}

}  // namespace vdb_madf::detail
