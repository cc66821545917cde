// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/scans/mask_cleaning.h"

#include <memory>
#include <vector>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/detail/connected_components.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/method/cavities.h"

namespace vdb_madf {

namespace {

using detail::ConnectedComponents;
using MaskLeaf = MaskTree::LeafNodeType;
using Word = openvdb::Index64;

openvdb::util::NodeMask<3> bitsOf(const LeafIndex::Mask& mask) {
  openvdb::util::NodeMask<3> bits;
  for (openvdb::Index x = 0; x < 8; ++x) bits.getWord<Word>(x) = mask[x];
  return bits;
}

/// Replaces the object by those of its components that are kept.
void keepComponents(MaskGrid& mask, const LeafIndex& index, const ConnectedComponents& components,
                    const std::vector<bool>& kept) {
  const auto tree = std::make_shared<MaskTree>();
  openvdb::tree::ValueAccessor<MaskTree> accessor(*tree);
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    LeafIndex::Mask voxels{};
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      if (kept[piece->component]) voxels = detail::either(voxels, piece->mask);
    if (!detail::anyVoxel(voxels)) continue;
    auto node = std::make_unique<MaskLeaf>(index.origin(leaf), false);
    node->setValueMask(bitsOf(voxels));
    accessor.addLeaf(node.release());
  }
  mask.setTree(tree);
}

void dropIslands(MaskGrid& mask, int64_t voxels, Despeckled& counts, Interrupter* interrupter) {
  const LeafIndex index(mask);
  const ConnectedComponents components(index, interrupter);
  std::vector<int64_t> sizes(components.count());
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf)
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      sizes[piece->component] += detail::countVoxels(piece->mask);
  std::vector<bool> kept(sizes.size());
  for (size_t i = 0; i < sizes.size(); ++i) {
    kept[i] = sizes[i] >= voxels;
    if (kept[i]) continue;
    ++counts.islands;
    counts.islandVoxels += sizes[i];
  }
  if (counts.islands > 0) keepComponents(mask, index, components, kept);
}

void fillCavities(MaskGrid& mask, int64_t voxels, Despeckled& counts, Interrupter* interrupter) {
  const auto domain = storedDomain(mask);
  const Cavities cavities =
      findCavities(LeafIndex(mask), domain, domain.has_value(), voxels, interrupter);
  openvdb::tree::ValueAccessor<MaskTree> accessor(mask.tree());
  for (const LeafIndex::LeafVoxels& leaf : cavities.leaves) {
    MaskLeaf* const node = accessor.touchLeaf(leaf.origin);
    node->setValueMask(node->getValueMask() | bitsOf(leaf.mask));
  }
  counts.cavities = cavities.count;
  counts.cavityVoxels = cavities.voxels;
}

}  // namespace

Despeckled despeckle(MaskGrid& mask, int64_t voxels, Interrupter* interrupter) {
  Despeckled counts;
  if (voxels <= 1) return counts;
  dropIslands(mask, voxels, counts, interrupter);
  fillCavities(mask, voxels, counts, interrupter);
  return counts;
}

void keepSeeded(MaskGrid& mask, const MaskGrid& seeds, Interrupter* interrupter) {
  const LeafIndex index(mask);
  const ConnectedComponents components(index, interrupter);
  std::vector<bool> kept(components.count());
  openvdb::tree::ValueAccessor<const MaskTree> accessor(seeds.tree());
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const MaskLeaf* const node = accessor.probeConstLeaf(index.origin(leaf));
    if (!node) continue;
    const LeafIndex::Mask voxels = detail::maskOf(*node);
    for (auto piece = components.begin(leaf); piece != components.end(leaf); ++piece)
      if (detail::meet(piece->mask, voxels)) kept[piece->component] = true;
  }
  keepComponents(mask, index, components, kept);
}

}  // namespace vdb_madf
