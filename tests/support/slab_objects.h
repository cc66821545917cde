// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "support/random_volume.h"
#include "vdb_madf/slabs/segment_slabs.h"

// Objects in slabs, and what comes of them.

namespace vdb_madf::test {

/// The leaves of a mask in slabs with these cuts.
inline SlabObject cutObject(const MaskGrid& mask, std::vector<int> cuts) {
  std::vector<std::vector<LeafIndex::LeafVoxels>> leaves(cuts.size() - 1);
  const LeafIndex index(mask);
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const auto above = std::upper_bound(cuts.begin(), cuts.end(), index.origin(leaf).z());
    if (above == cuts.begin() || above == cuts.end())
      throw std::logic_error("cuts leave the object");
    leaves[size_t(above - cuts.begin()) - 1].push_back({index.origin(leaf), index.mask(leaf)});
  }
  SlabObject object;
  object.cuts = std::move(cuts);
  object.leaves = [leaves](size_t slab) { return leaves[slab]; };
  object.about = openvdb::gridConstPtrCast<MaskGrid>(mask.copyGridWithNewTree());
  return object;
}

/// The layers of leaf nodes, by their z.
inline std::map<int, MaskTree> layersOf(const MaskGrid& mask) {
  std::map<int, MaskTree> layers;
  for (auto voxel = mask.cbeginValueOn(); voxel; ++voxel) {
    CoordBBox box;
    voxel.getBoundingBox(box);  // of a tile
    for (auto p = box.begin(); p; ++p) layers[(*p).z() & ~7].setValueOn(*p);
  }
  return layers;
}

/// At every layer of leaves, or at some or few of them, so that slabs are high; now and then there
/// are empty slabs at the ends.
inline std::vector<int> randomCuts(const CoordBBox& box, Rng& rng) {
  const int first = (box.min().z() & ~7) - 8 * rng.below(2);
  const int last = (box.max().z() | 7) + 1 + 8 * rng.below(2);
  std::vector<int> cuts{first};
  const double share = rng.chance(0.4) ? 1 : rng.unit() * rng.unit();
  for (int z = first + 8; z < last; z += 8)
    if (rng.chance(share)) cuts.push_back(z);
  cuts.push_back(last);
  return cuts;
}

/// Are they the same voxels, values and metadata?
inline bool areSame(const Int32Grid& a, const Int32Grid& b) {
  if (a.activeVoxelCount() != b.activeVoxelCount() || a.transform() != b.transform()) return false;
  const auto tree = b.getConstAccessor();
  for (auto voxel = a.cbeginValueOn(); voxel; ++voxel)
    if (tree.getValue(voxel.getCoord()) != *voxel) return false;
  if (a.metaCount() != b.metaCount()) return false;
  for (auto meta = a.beginMeta(); meta != a.endMeta(); ++meta)
    if (!b[meta->first] || *b[meta->first] != *meta->second) return false;
  return true;
}

}  // namespace vdb_madf::test
