// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/exports/detail/coarse_trees.h"

#include <algorithm>
#include <array>
#include <memory>
#include <tuple>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/labels/detail/label_blocks.h"
#include "vdb_madf/labels/detail/reduction.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

namespace {

using Leaf = Int32Tree::LeafNodeType;

int32_t grayOf(int64_t labelled, int64_t all) {
  return int32_t((2 * 255 * labelled + all) / (2 * all));
}

void countLeaf(const Leaf& leaf, std::vector<LabelCount>& counts) {
  std::array<int32_t, Leaf::SIZE> labels;
  for (openvdb::Index i = 0; i < Leaf::SIZE; ++i)
    labels[i] = labelAt(leaf, leaf.buffer().data(), i);
  std::sort(labels.begin(), labels.end());
  auto begin = std::upper_bound(labels.begin(), labels.end(), 0);
  while (begin != labels.end()) {
    const auto end = std::upper_bound(begin, labels.end(), *begin);
    counts.push_back({leaf.origin(), *begin, end - begin});
    begin = end;
  }
}

}  // namespace

CoarseTrees coarseTrees(const Int32Grid& labels, int factor, const std::optional<Domain>& domain,
                        Interrupter* interrupter) {
  const Reduction reduction(labels, factor, domain);
  std::vector<std::unique_ptr<Leaf>> label(reduction.leafCount()), gray(reduction.leafCount());
  reduction.run(
      [&](size_t n, const Coord& origin, const Cells& cells) {
        label[n] = leafAt<Int32Grid>(origin);
        gray[n] = leafAt<Int32Grid>(origin);
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
          if (cells[i].labelled == 0) continue;
          const int32_t part = grayOf(cells[i].labelled, cells[i].all);
          if (cells[i].majority) label[n]->setValueOn(i, cells[i].majority);
          if (part) gray[n]->setValueOn(i, part);
        }
      },
      interrupter);
  CoarseTrees trees;
  for (size_t n = 0; n < label.size(); ++n) {
    if (!label[n]->isEmpty()) trees.label.addLeaf(label[n].release());
    if (!gray[n]->isEmpty()) trees.gray.addLeaf(gray[n].release());
  }
  return trees;
}

std::vector<LabelCount> countLabels(const Int32Tree& labels, Interrupter* interrupter) {
  const auto leaves = leavesOf(labels);
  std::vector<std::vector<LabelCount>> parts((leaves.size() + kLightLeafGrain - 1) /
                                             kLightLeafGrain);
  parallelForEach(parts.size(), 1, interrupter, [&](size_t part) {
    for (size_t n = part * kLightLeafGrain;
         n < std::min(leaves.size(), (part + 1) * kLightLeafGrain); ++n)
      countLeaf(*leaves[n], parts[part]);
  });
  std::vector<LabelCount> counts;
  for (const auto& part : parts) counts.insert(counts.end(), part.begin(), part.end());
  return counts;
}

bool CoarseCounts::comesBefore(const Entry& a, const Entry& b) {
  const auto key = [](const Entry& e) {
    return std::make_tuple(e.leaf.z(), e.leaf.y(), e.leaf.x(), e.label);
  };
  return key(a) < key(b);
}

void CoarseCounts::add(const std::vector<LabelCount>& counts) {
  for (const LabelCount& count : counts)
    entries_.push_back({floorDiv(count.leaf, factor_), count.label, count.voxels});
  std::sort(entries_.begin(), entries_.end(), comesBefore);
  size_t kept = 0;
  for (size_t i = 0; i < entries_.size(); ++i)
    if (kept > 0 && !comesBefore(entries_[kept - 1], entries_[i]))
      entries_[kept - 1].voxels += entries_[i].voxels;
    else
      entries_[kept++] = entries_[i];
  entries_.resize(kept);
}

CoarseTrees CoarseCounts::take(int end) {
  CoarseTrees trees;
  auto begin = entries_.begin();
  while (begin != entries_.end() && begin->leaf.z() < end) {
    const Coord voxel = begin->leaf;
    int64_t labelled = 0;
    auto most = begin;
    for (; begin != entries_.end() && begin->leaf == voxel; ++begin) {
      labelled += begin->voxels;
      if (begin->voxels > most->voxels) most = begin;  // of equal ones the smallest label
    }
    const int64_t all = std::max(fineVoxels(voxel, factor_, domain_), labelled);
    if (most->voxels > all - labelled) trees.label.setValueOn(voxel, most->label);
    if (const int32_t part = grayOf(labelled, all)) trees.gray.setValueOn(voxel, part);
  }
  entries_.erase(entries_.begin(), begin);
  return trees;
}

}  // namespace vdb_madf::detail
