// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/interface_voxels.h"

#include <memory>

#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
bool isAtInterface(const detail::LabelHalo& halo, size_t at) {
  const int32_t own = halo[at];
  if (own == 0) return false;
  for (const int stride : detail::kHaloStride)
    for (const int32_t other : {halo[at - size_t(stride)], halo[at + size_t(stride)]})
      if (other != 0 && other != own) return true;
  return false;
}

/// Null if no voxel of the leaf is at an interface.
std::unique_ptr<Leaf> interfacesIn(const Int32Tree& tree, const Coord& origin) {
  detail::LabelHalo halo;
  detail::readLabelHalo(tree, origin, halo);
  std::unique_ptr<Leaf> part;
  for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
    const Coord p = Leaf::offsetToLocalCoord(i);
    const size_t at = detail::haloAt(p.x(), p.y(), p.z());
    if (!isAtInterface(halo, at)) continue;
    if (!part) part = std::make_unique<Leaf>(origin, 0);
    part->setValueOn(i, halo[at]);
  }
  return part;
}

}  // namespace

Int32Grid::Ptr interfaceVoxels(const Int32Grid& labels, Interrupter* interrupter) {
  const Int32Tree::ConstPtr tree = detail::withoutTiles(labels);
  const auto result = Int32Grid::create(0);
  copyProvenance(labels, *result);
  result->setName(labels.getName());
  const auto leaves = detail::leavesOf(*tree);
  detail::addLeaves(result->tree(), leaves.size(), detail::kLeafGrain, interrupter,
                    [&](size_t n) { return interfacesIn(*tree, leaves[n]->origin()); });
  return result;
}

}  // namespace vdb_madf
