// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/bond_depths.h"

#include <algorithm>
#include <array>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

/// The faces whose lower voxel lies in a leaf. One per thread.
class LeafBondDepths {
 public:
  LeafBondDepths(const LabelLeaves& labels, const VoxelArray<int32_t>& distances)
      : labels_(&labels), distances_(&distances) {}

  void add(size_t leaf) {
    if (isOneGrain(leaf)) return;
    const LeafIndex& index = labels_->index();
    std::array<int32_t, 512> own{};
    for (const LabelPart& part : labels_->parts(leaf))
      for (size_t x = 0; x < 8; ++x)
        forEachBit(part.mask[x], [&](int bit) { own[x << 6 | size_t(bit)] = part.label; });
    forEachVoxel(index, leaf, leaf + 1, [&](VoxelId id, size_t rank) {
      forEachNeighbor(index, id, [&](VoxelId upper, int, int step) {
        if (step < 0 || !isObject(index, upper)) return;
        const int32_t first = own[offsetOf(id)],
                      second = leafOf(upper) == leaf ? own[offsetOf(upper)] : labelOf(upper);
        if (first == second) return;
        int32_t& depth = depths[std::minmax(first, second)];
        depth = std::max(depth, std::min((*distances_)[rank], (*distances_)[index.rank(upper)]));
      });
    });
  }

  BondDepths depths;

 private:
  int32_t labelOf(VoxelId id) const { return labels_->label(leafOf(id), int(offsetOf(id))); }
  bool isOneGrain(size_t leaf) const {
    const auto isOnly = [&](size_t other, int32_t label) {
      const LabelLeaves::Parts parts = labels_->parts(other);
      return parts.size() == 1 && parts.begin()->label == label;
    };
    const int32_t label = labels_->parts(leaf).begin()->label;
    const LeafIndex::Neighbors& neighbors = labels_->index().neighbors(leaf);
    const auto goesOn = [&](uint32_t above) {
      return above == LeafIndex::kNone || isOnly(above, label);
    };
    return isOnly(leaf, label) && goesOn(neighbors[1]) && goesOn(neighbors[3]) &&
           goesOn(neighbors[5]);
  }

  const LabelLeaves* labels_;
  const VoxelArray<int32_t>* distances_;
};

}  // namespace

void addBondDepths(const LabelLeaves& labels, const LeafLayers& layers,
                   const VoxelArray<int32_t>& distances, BondDepths& depths,
                   Interrupter* interrupter) {
  const LeafIndex& index = labels.index();
  PerThread<LeafBondDepths> finders([&] { return LeafBondDepths(labels, distances); });
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    LeafBondDepths& finder = finders.local();
    for (size_t leaf = begin; leaf < end; ++leaf)
      if (layers.hold(index.origin(leaf))) finder.add(leaf);
  });
  for (const LeafBondDepths& finder : finders)
    for (const auto& [pair, found] : finder.depths) {
      int32_t& depth = depths[pair];
      depth = std::max(depth, found);
    }
}

}  // namespace vdb_madf::detail
