// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf::detail {

/// The least and the greatest value of a site over the voxels of a cube, or bounds of them.
struct ValueRange {
  double least, greatest;
};

/// Closes the gaps that owners without a voxel leave in the labels 1..count. @throw Interrupted
void numberOwners(Int32Tree& labels, size_t count, Interrupter* interrupter);

/// Gives each voxel p of the object the site of least value (tie: the earlier one), in the object's
/// topology. The sites that own a voxel are numbered 1..N in their order. The object must have no
/// active tiles. `Sites` has size(), value(i, p), range(i, lower corner, edge) over the voxels of a
/// cube, and kSlack, far above the rounding of values. @throw Interrupted
template <typename Sites>
class LeastCells {
 public:
  explicit LeastCells(const Sites& sites) : sites_(sites) {}

  Int32Tree::Ptr label(const MaskTree& object, Interrupter* interrupter) const {
    auto labels = std::make_shared<Int32Tree>(object, 0, openvdb::TopologyCopy());
    std::map<Coord, std::vector<Leaf*>> regions;
    for (Leaf* leaf : leavesOf(*labels))
      regions[leaf->origin() & ~(kRegionEdge - 1)].push_back(leaf);
    const std::vector<std::pair<Coord, std::vector<Leaf*>>> work(regions.begin(), regions.end());

    std::vector<int32_t> all(sites_.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = int32_t(i);
    parallelForEach(work.size(), 1, interrupter, [&](size_t i) {
      const auto inRegion = candidates(all, work[i].first, kRegionEdge);
      for (Leaf* leaf : work[i].second)
        labelLeaf(*leaf, candidates(inRegion, leaf->origin(), int(Leaf::DIM)));
    });
    numberOwners(*labels, sites_.size(), interrupter);
    return labels;
  }

 private:
  using Leaf = Int32Tree::LeafNodeType;

  /// Edge of the regions whose candidates are listed once for all their leaves.
  static constexpr int kRegionEdge = 64;

  /// The sites among some that may have the least value somewhere in the cube, in order.
  std::vector<int32_t> candidates(const std::vector<int32_t>& among, const Coord& lower,
                                  int edge) const {
    std::vector<ValueRange> ranges;
    double bound = std::numeric_limits<double>::infinity();
    for (const int32_t i : among) {
      ranges.push_back(sites_.range(size_t(i), lower, edge));
      bound = std::min(bound, ranges.back().greatest);
    }
    std::vector<int32_t> result;
    for (size_t k = 0; k < among.size(); ++k)
      if (ranges[k].least <= bound + Sites::kSlack) result.push_back(among[k]);
    return result;
  }

  void labelLeaf(Leaf& leaf, const std::vector<int32_t>& near) const {
    int32_t* labels = leaf.buffer().data();
    for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) {
      const Coord p = voxel.getCoord();
      double best = std::numeric_limits<double>::infinity();
      for (const int32_t i : near) {
        const double value = sites_.value(size_t(i), p);
        if (value < best) {
          best = value;
          labels[voxel.pos()] = i + 1;
        }
      }
    }
  }

  const Sites& sites_;
};

}  // namespace vdb_madf::detail
