// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/measure/detail/component_count.h"

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"

namespace vdb_madf::detail {

namespace {

constexpr uint32_t kNone = ~uint32_t(0);

/// The components of the voxels of a leaf's lowest or highest layer, by x*8 + y; kNone: no voxel.
std::array<uint32_t, 64> layerOf(const ConnectedComponents& components, size_t leaf, int z) {
  std::array<uint32_t, 64> layer;
  layer.fill(kNone);
  for (const auto* piece = components.begin(leaf); piece != components.end(leaf); ++piece)
    forEachBit(layersAlongZ(piece->mask)[size_t(z)],
               [&](int place) { layer[size_t(place)] = piece->component; });
  return layer;
}

}  // namespace

void ComponentCount::add(const LeafIndex& slab, const LeafLayers& layers,
                         Interrupter* interrupter) {
  const ConnectedComponents components(slab, interrupter);
  DisjointSets sets(size_t(classes_) + components.count());
  count_ += components.count();
  for (const Top& top : tops_) {
    const auto leaf = slab.findLeaf(beside(top.origin, 5));
    if (!leaf) continue;
    const auto bottom = layerOf(components, *leaf, 0);
    for (size_t place = 0; place < 64; ++place) {
      if (top.classes[place] == kNone || bottom[place] == kNone) continue;
      const uint32_t below = top.classes[place], above = classes_ + bottom[place];
      if (sets.find(below) == sets.find(above)) continue;
      sets.unite(below, above);
      --count_;
    }
  }
  std::vector<uint32_t> numbers(size_t(classes_) + components.count(), kNone);
  tops_.clear();
  uint32_t count = 0;
  for (size_t leaf = 0; leaf < slab.leafCount(); ++leaf) {
    if (int64_t(slab.origin(leaf).z()) + 8 != layers.end) continue;
    Top top{slab.origin(leaf), layerOf(components, leaf, 7)};
    for (uint32_t& component : top.classes) {
      if (component == kNone) continue;
      uint32_t& number = numbers[sets.find(classes_ + component)];
      if (number == kNone) number = count++;
      component = number;
    }
    tops_.push_back(top);
  }
  classes_ = count;
}

}  // namespace vdb_madf::detail
