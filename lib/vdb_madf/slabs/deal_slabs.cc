// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/deal_slabs.h"

#include <algorithm>
#include <string>
#include <utility>

#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/slabs/detail/object_pieces.h"

namespace vdb_madf {

namespace {

using Leaves = std::vector<LeafIndex::LeafVoxels>;

std::string dealtName(int from) {
  return "dealt-" + std::to_string(from);
}

/// None, if there is no such piece.
Leaves readIfAny(const Scratch& scratch, const std::string& name) {
  return scratch.has(name) ? detail::readLeaves(scratch, name) : Leaves();
}

/// Object voxels of each layer, of all ranks.
struct Layers {
  int first = 0;  ///< z of the lowest
  std::vector<int64_t> voxels;
};

Layers countLayers(const Leaves& leaves, const std::optional<Domain>& domain, Ranks& ranks) {
  CoordBBox box;
  for (const LeafIndex::LeafVoxels& leaf : leaves) box.expand(leaf.origin);
  if (domain && !domain->box().empty()) box.expand(domain->box());
  std::vector<int64_t> ends{-int64_t(box.min().z()), box.max().z()};
  ranks.max(ends);
  if (-ends[0] > ends[1]) return {0, {0}};  // nothing at all
  Layers layers;
  layers.first = int(-ends[0]) & ~7;
  layers.voxels.assign(size_t((ends[1] - layers.first) / 8 + 1), 0);
  for (const LeafIndex::LeafVoxels& leaf : leaves)
    layers.voxels[size_t(leaf.origin.z() - layers.first) / 8] += detail::countVoxels(leaf.mask);
  ranks.sum(layers.voxels);
  return layers;
}

std::vector<int> chooseCuts(const Layers& layers, const SlabLimits& limits, int ranks) {
  int64_t total = 0;
  for (const int64_t voxels : layers.voxels) total += voxels;
  int64_t most = total / ranks + 1;
  if (limits.voxels > 0) most = std::min(most, limits.voxels);
  std::vector<int> cuts{layers.first};
  int64_t inSlab = 0;
  for (size_t layer = 0; layer < layers.voxels.size(); ++layer) {
    const int z = layers.first + int(layer) * 8, height = z - cuts.back();
    // A cut where the slab's share is nearer than after this layer.
    const bool isFull = inSlab > 0 && inSlab + layers.voxels[layer] / 2 >= most;
    const bool isHigh = limits.height > 0 && height + 8 > (limits.height + 7) / 8 * 8;
    if (height >= std::max(limits.leastHeight, 8) && (isFull || isHigh)) {
      cuts.push_back(z);
      inSlab = 0;
    }
    inSlab += layers.voxels[layer];
  }
  cuts.push_back(layers.first + int(layers.voxels.size()) * 8);
  return cuts;
}

}  // namespace

SlabObject dealSlabs(Leaves leaves, const SlabLimits& limits, int64_t reach,
                     const std::optional<Domain>& domain, MaskGrid::ConstPtr about, Ranks& ranks,
                     Scratch& scratch) {
  SlabObject object;
  object.about = std::move(about);
  object.cuts = chooseCuts(countLayers(leaves, domain, ranks), limits, ranks.count());
  const std::vector<int>& cuts = object.cuts;
  const size_t slabs = object.slabCount();

  for (int rank = 0; rank < ranks.count(); ++rank) {
    const size_t first = ranks.firstSlab(rank, slabs), last = ranks.firstSlab(rank + 1, slabs);
    if (first == last) continue;
    Leaves wanted;
    for (const LeafIndex::LeafVoxels& leaf : leaves)
      if (leaf.origin.z() + 8 + reach > cuts[first] && leaf.origin.z() - reach < cuts[last])
        wanted.push_back(leaf);
    if (wanted.empty()) continue;
    detail::ByteWriter bytes;
    bytes.add(wanted);
    ranks.send(rank, dealtName(ranks.rank()), bytes.bytes(), scratch);
  }
  leaves = {};
  ranks.exchange(scratch);

  std::vector<Leaves> ofSlab(slabs);
  for (int rank = 0; rank < ranks.count(); ++rank) {
    for (const LeafIndex::LeafVoxels& leaf : readIfAny(scratch, dealtName(rank))) {
      const auto above = std::upper_bound(cuts.begin(), cuts.end(), leaf.origin.z());
      ofSlab[size_t(above - cuts.begin()) - 1].push_back(leaf);
    }
    scratch.remove(dealtName(rank));
  }
  for (size_t s = 0; s < slabs; ++s) {
    if (ofSlab[s].empty()) continue;
    std::sort(ofSlab[s].begin(), ofSlab[s].end(),
              [](const auto& a, const auto& b) { return a.origin < b.origin; });
    detail::writeLeaves(scratch, detail::objectName(s), ofSlab[s]);
  }
  object.leaves = [&scratch](size_t slab) { return readIfAny(scratch, detail::objectName(slab)); };
  return object;
}

}  // namespace vdb_madf
