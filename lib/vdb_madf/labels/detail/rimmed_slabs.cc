// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/rimmed_slabs.h"

#include <vector>

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

/// Copies of the leaves in a layer.
std::vector<Leaf*> copyLayer(const Int32Grid& from, int z) {
  std::vector<Leaf*> layer;
  for (auto leaf = from.tree().cbeginLeaf(); leaf; ++leaf)
    if (leaf->origin().z() == z) layer.push_back(new Leaf(*leaf));
  return layer;
}

void addLayer(const std::vector<Leaf*>& layer, Int32Grid& to) {
  for (Leaf* const leaf : layer) to.tree().addLeaf(leaf);
}

}  // namespace

Int32Grid::Ptr RimmedSlabs::read(size_t slab, Interrupter* interrupter) const {
  if (slab >= slabs_.slabCount()) return nullptr;
  const Int32Grid::Ptr labels = slabs_.read(slab, interrupter);
  labels->tree().voxelizeActiveTiles();
  return labels;
}

bool RimmedSlabs::next(Interrupter* interrupter) {
  std::vector<Leaf*> below;
  if (!slab_) {
    slab_ = read(0, interrupter);
  } else {
    ++at_;
    if (above_) below = copyLayer(*slab_, slabs_.cuts[at_] - 8);
    slab_ = above_;
  }
  if (!slab_) return false;
  addLayer(below, *slab_);
  above_ = read(at_ + 1, interrupter);
  if (above_) addLayer(copyLayer(*above_, slabs_.cuts[at_ + 1]), *slab_);
  return true;
}

}  // namespace vdb_madf::detail
