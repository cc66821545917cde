// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/label_sizes.h"

#include <mutex>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
using Sizes = std::map<int32_t, int64_t>;
void addVoxels(const Leaf& leaf, Sizes& sizes) {
  auto last = sizes.end();  // neighbors mostly share their label
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel <= 0) continue;
    if (last == sizes.end() || last->first != *voxel) last = sizes.try_emplace(*voxel, 0).first;
    ++last->second;
  }
}

}  // namespace

std::map<int32_t, int64_t> labelSizes(const Int32Grid& labels, Interrupter* interrupter) {
  Sizes sizes;
  std::mutex mutex;
  const auto leaves = detail::leavesOf(labels.tree());
  detail::parallelFor(leaves.size(), detail::kLightLeafGrain, interrupter,
                      [&](size_t begin, size_t end) {
                        Sizes local;
                        for (size_t n = begin; n < end; ++n) addVoxels(*leaves[n], local);
                        // Integer sums: the order in which the parts arrive does not matter.
                        const std::lock_guard<std::mutex> lock(mutex);
                        for (const auto& [label, voxels] : local) sizes[label] += voxels;
                      });
  auto tile = labels.tree().cbeginValueOn();
  tile.setMaxDepth(Int32Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile)
    if (*tile > 0) sizes[*tile] += int64_t(tile.getVoxelCount());
  return sizes;
}

std::map<int32_t, int64_t> labelSizes(const LabelSlabs& labels, Interrupter* interrupter) {
  Sizes sizes;
  for (size_t slab = 0; slab < labels.slabCount(); ++slab)
    for (const auto& [label, voxels] : labelSizes(*labels.read(slab, interrupter), interrupter))
      sizes[label] += voxels;
  return sizes;
}

}  // namespace vdb_madf
