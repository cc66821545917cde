// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/leaves/detail/label_masks.h"
#include "vdb_madf/leaves/detail/leaf_mask.h"
#include "vdb_madf/leaves/detail/leaf_neighborhood.h"
#include "vdb_madf/method/detail/tidy_steps.h"
#include "vdb_madf/method/detail/voxels_around.h"

namespace vdb_madf::detail {

namespace {

using Mask = LeafIndex::Mask;

/// Voxels of a leaf that a round gives a label.
struct Taking {
  uint32_t leaf, label;
  Mask voxels;
};

/// What a round does to one leaf after the other. One per thread.
class LeafSmoothing {
 public:
  LeafSmoothing(const LeafIndex& index, const LabelMasks& masks, const std::vector<VoxelId>& anchor)
      : index_(index), masks_(masks), anchor_(anchor), neighborhood_(index) {}

  void addTakings(uint32_t leaf, std::vector<Taking>& takings) {
    findLabels(leaf);
    if (labels_.size() < 2) return;
    findMasks(leaf);
    // Each voxel keeps its label unless another one is more frequent; then by rising label.
    LeafCounts best{};
    for (Candidate& c : candidates_) {
      c.around = voxelsAround(c.masks);
      assignCounts(best, c.around.count, *c.masks[13]);
    }
    const Mask voxels = changeable(leaf);
    const size_t first = takings.size();
    for (size_t i = 0; i < candidates_.size(); ++i) {
      const Candidate& c = candidates_[i];
      const Mask offered = both(without(voxels, *c.masks[13]), c.around.faces);
      if (!anyVoxel(offered)) continue;
      const Mask taken = both(offered, isGreater(c.around.count, best));
      if (!anyVoxel(taken)) continue;
      assignCounts(best, c.around.count, taken);
      for (size_t k = first; k < takings.size(); ++k)
        takings[k].voxels = without(takings[k].voxels, taken);
      takings.push_back({leaf, labels_[i], taken});
    }
  }

 private:
  struct Candidate {
    std::array<const Mask*, 27> masks;  // of one label, as LeafNeighborhood tells the leaves
    VoxelsAround around;
  };

  /// Lists the labels in a leaf and across its faces, ascending. The list may have labels that do
  /// not touch, but misses none that does: with one label alone nothing changes here.
  void findLabels(uint32_t leaf) {
    labels_.clear();
    for (auto entry = masks_.begin(leaf); entry != masks_.end(leaf); ++entry)
      labels_.push_back(entry->label);
    const size_t own = labels_.size();
    for (size_t side = 0; side < 6; ++side) {
      const uint32_t next = index_.neighbors(leaf)[side];
      if (next == LeafIndex::kNone) continue;
      for (auto entry = masks_.begin(next); entry != masks_.end(next); ++entry)
        if (!std::binary_search(labels_.begin(), labels_.begin() + std::ptrdiff_t(own),
                                entry->label) &&
            meet(across(entry->mask, opposite(side)), index_.mask(leaf)))
          labels_.push_back(entry->label);
    }
    if (labels_.size() == own) return;
    sortUnique(labels_);
  }

  void findMasks(uint32_t leaf) {
    static constexpr Mask kNone{};
    candidates_.resize(labels_.size());
    const std::array<uint32_t, 27>& around = neighborhood_.around(leaf);
    for (size_t i = 0; i < 27; ++i) {
      const bool exists = around[i] != LeafIndex::kNone;
      auto entry = exists ? masks_.begin(around[i]) : nullptr;
      const auto end = exists ? masks_.end(around[i]) : nullptr;
      for (size_t k = 0; k < labels_.size(); ++k) {
        while (entry != end && entry->label < labels_[k]) ++entry;
        candidates_[k].masks[i] =
            entry != end && entry->label == labels_[k] ? &entry->mask : &kNone;
      }
    }
  }

  /// The voxels with a label, but for anchors.
  Mask changeable(uint32_t leaf) const {
    Mask voxels{};
    for (auto entry = masks_.begin(leaf); entry != masks_.end(leaf); ++entry) {
      voxels = either(voxels, entry->mask);
      const VoxelId anchor = anchor_[entry->label - 1];
      if (anchor != kNoAnchor && leafOf(anchor) == leaf)
        voxels[wordOf(anchor)] &= ~(uint64_t(1) << bitOf(anchor));
    }
    return voxels;
  }

  const LeafIndex& index_;
  const LabelMasks& masks_;
  const std::vector<VoxelId>& anchor_;
  LeafNeighborhood neighborhood_;
  std::vector<uint32_t> labels_;
  std::vector<Candidate> candidates_;  // of labels_
};

/// Some leaves, ascending, by the chunks of LabelMasks.
using LeafChunks = std::vector<std::vector<uint32_t>>;
/// What they take, by the same.
using Takings = std::vector<std::vector<Taking>>;

/// The leaves that are marked.
LeafChunks chunksOf(const std::vector<char>& marks) {
  LeafChunks chunks;
  for (uint32_t leaf = 0; leaf < marks.size(); ++leaf) {
    if (leaf % LabelMasks::kChunk == 0) chunks.emplace_back();
    if (marks[leaf]) chunks.back().push_back(leaf);
  }
  return chunks;
}

Takings decide(const LeafIndex& index, const LabelMasks& masks, const std::vector<VoxelId>& anchor,
               const LeafChunks& leaves, Interrupter* interrupter) {
  Takings takings(leaves.size());
  parallelFor(takings.size(), 1, interrupter, [&](size_t begin, size_t end) {
    LeafSmoothing smoothing(index, masks, anchor);
    for (size_t i = begin; i < end; ++i)
      for (const uint32_t leaf : leaves[i]) smoothing.addTakings(leaf, takings[i]);
  });
  return takings;
}

/// Marks a leaf, and those whose layer of neighbors holds one of some voxels of it.
void markLeaves(const std::array<uint32_t, 27>& around, const Mask& voxels,
                std::vector<char>& marks) {
  uint64_t all = 0;
  for (const uint64_t word : voxels) all |= word;
  const uint64_t words[3] = {voxels[0], all, voxels[7]};
  constexpr uint64_t kY[3] = {kFirstY, ~uint64_t(0), kLastY};
  constexpr uint64_t kZ[3] = {kFirstZ, ~uint64_t(0), kLastZ};
  for (size_t i = 0; i < 27; ++i)
    if (around[i] != LeafIndex::kNone && (words[i / 9] & kY[i / 3 % 3] & kZ[i % 3]))
      __atomic_store_n(&marks[around[i]], char(1), __ATOMIC_RELAXED);
}

void add(std::vector<int64_t>& voxels, uint32_t label, int64_t more) {
  if (more != 0) __atomic_fetch_add(&voxels[label - 1], more, __ATOMIC_RELAXED);
}

/// Returns marks of the leaves that see a change.
std::vector<char> apply(const LeafIndex& index, const Takings& takings, LabelMasks& masks,
                        GrainLabels& grains, Interrupter* interrupter) {
  std::vector<char> marks(index.leafCount(), 0);
  parallelFor(takings.size(), 1, interrupter, [&](size_t begin, size_t end) {
    LeafNeighborhood neighborhood(index);
    for (size_t i = begin; i < end; ++i)
      for (const Taking& taking : takings[i]) {
        for (auto entry = masks.begin(taking.leaf); entry != masks.end(taking.leaf); ++entry)
          add(grains.voxels, entry->label, -int64_t(countVoxels(both(entry->mask, taking.voxels))));
        add(grains.voxels, taking.label, countVoxels(taking.voxels));
        masks.give(taking.leaf, taking.label, taking.voxels);
        markLeaves(neighborhood.around(taking.leaf), taking.voxels, marks);
        for (uint32_t x = 0; x < 8; ++x)
          forEachBit(taking.voxels[x], [&](int bit) {
            grains.label[index.rank(voxelId(taking.leaf, x, size_t(bit)))] = taking.label;
          });
      }
  });
  return marks;
}

}  // namespace

void smoothInterfaces(const LeafIndex& index, int rounds, const std::vector<VoxelId>& anchor,
                      LabelMasks& masks, GrainLabels& grains, Interrupter* interrupter) {
  std::vector<char> marks(index.leafCount(), 1);
  for (int round = 0; round < rounds; ++round) {
    const LeafChunks leaves = chunksOf(marks);
    marks =
        apply(index, decide(index, masks, anchor, leaves, interrupter), masks, grains, interrupter);
  }
}

}  // namespace vdb_madf::detail
