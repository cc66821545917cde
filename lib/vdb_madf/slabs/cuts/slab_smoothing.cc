// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_smoothing.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/voxels.h"
#include "vdb_madf/method/detail/tidy_steps.h"

namespace vdb_madf::detail {

namespace {

/// A leaf beyond a cut, and where its labels are.
struct BeyondLeaf {
  LeafIndex::LeafVoxels leaf;
  const uint32_t* labels;
};

void addLeaves(const LeafLabels& rim, std::vector<BeyondLeaf>& sources) {
  const uint32_t* next = rim.labels.data();
  for (const LeafIndex::LeafVoxels& leaf : rim.leaves) {
    sources.push_back({leaf, next});
    next += countVoxels(leaf.mask);
  }
}

}  // namespace

LeafLabels labelsBetween(const LeafIndex& index, const VoxelArray<uint32_t>& labels, int begin,
                         int end) {
  LeafLabels result;
  for (size_t leaf = 0; leaf < index.leafCount(); ++leaf) {
    const Coord& origin = index.origin(leaf);
    if (origin.z() < begin || origin.z() >= end) continue;
    result.leaves.push_back({origin, index.mask(leaf)});
    const uint32_t* first = labels.data() + index.firstRank(leaf);
    result.labels.insert(result.labels.end(), first, first + index.leafVoxels(leaf));
  }
  return result;
}

LabelWindow labelWindow(const LeafIndex& index, const VoxelArray<uint32_t>& labels,
                        const LeafLabels& below, const LeafLabels& above) {
  std::vector<BeyondLeaf> beyond;
  addLeaves(below, beyond);
  const auto middle = std::ptrdiff_t(beyond.size());
  addLeaves(above, beyond);
  std::inplace_merge(
      beyond.begin(), beyond.begin() + middle, beyond.end(),
      [](const BeyondLeaf& a, const BeyondLeaf& b) { return a.leaf.origin < b.leaf.origin; });
  std::vector<LeafIndex::LeafVoxels> leaves;
  for (const BeyondLeaf& source : beyond) leaves.push_back(source.leaf);
  LabelWindow window;
  window.index = LeafIndex(index, leaves);
  window.labels = VoxelArray<uint32_t>(size_t(window.index.voxelCount()));

  std::vector<const uint32_t*> sources;
  auto next = beyond.begin();
  for (uint32_t leaf = 0; leaf < window.index.leafCount(); ++leaf) {
    if (next != beyond.end() && next->leaf.origin == window.index.origin(leaf)) {
      sources.push_back((next++)->labels);
    } else {
      sources.push_back(labels.data() + index.firstRank(window.ownLeaves.size()));
      window.ownLeaves.push_back(leaf);
    }
  }
  parallelForEach(sources.size(), kLeafGrain, nullptr, [&](size_t leaf) {
    std::copy_n(sources[leaf], window.index.leafVoxels(leaf),
                window.labels.data() + window.index.firstRank(leaf));
  });
  return window;
}

void smoothSlab(const LeafIndex& index, const LeafLabels& below, const LeafLabels& above,
                const Anchors& anchors, int rounds, VoxelArray<uint32_t>& labels,
                Interrupter* interrupter) {
  LabelWindow all = labelWindow(index, labels, below, above);
  const LeafIndex& window = all.index;
  GrainLabels grains;
  grains.label = std::move(all.labels);
  grains.voxels.assign(anchors.size(), 0);
  std::vector<VoxelId> anchorIds(anchors.size(), kNoAnchor);
  for (size_t g = 0; g < anchors.size(); ++g)
    if (window.boundingBox().isInside(anchors[g]))
      if (const auto id = window.findVoxel(anchors[g])) anchorIds[g] = *id;
  LabelMasks masks(window, grains.label, interrupter);
  smoothInterfaces(window, rounds, anchorIds, masks, grains, interrupter);

  parallelForEach(index.leafCount(), kLeafGrain, nullptr, [&](size_t leaf) {
    std::copy_n(grains.label.data() + window.firstRank(all.ownLeaves[leaf]), index.leafVoxels(leaf),
                labels.data() + index.firstRank(leaf));
  });
}

}  // namespace vdb_madf::detail
