// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/select_grains.h"

#include <algorithm>
#include <memory>
#include <string>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/detail/sorted.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using Leaf = Int32Tree::LeafNodeType;
/// The labels asked for, ascending, and which of them were found.
class Wanted {
 public:
  explicit Wanted(std::vector<int32_t> labels) : labels_(std::move(labels)) {
    detail::sortUnique(labels_);
    if (!labels_.empty() && labels_.front() < 1)
      throw InvalidInput("grain " + std::to_string(labels_.front()) +
                         " cannot be: labels are 1 and more");
    found_.assign(labels_.size(), 0);
  }
  bool holds(int32_t label) const {
    return std::binary_search(labels_.begin(), labels_.end(), label);
  }
  void find(int32_t label) { found_[detail::sortedIndex(labels_, label)] = 1; }
  void checkAllFound() const {
    for (size_t i = 0; i < labels_.size(); ++i)
      if (!found_[i]) throw InvalidInput("there is no grain " + std::to_string(labels_[i]));
  }

 private:
  std::vector<int32_t> labels_;
  std::vector<char> found_;
};

/// Null if nothing of the leaf is wanted.
std::unique_ptr<Leaf> wantedPart(const Leaf& leaf, const Wanted& wanted) {
  std::unique_ptr<Leaf> part;
  int32_t last = 0;  // neighbors mostly share their label
  bool keep = false;
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel != last) {
      last = *voxel;
      keep = wanted.holds(last);
    }
    if (!keep) continue;
    if (!part) part = std::make_unique<Leaf>(leaf.origin(), 0);
    part->setValueOn(voxel.pos(), last);
  }
  return part;
}

}  // namespace

Int32Grid::Ptr selectGrains(const Int32Grid& labels, const std::vector<int32_t>& grains,
                            Interrupter* interrupter) {
  Wanted wanted(grains);
  const auto selected = Int32Grid::create(0);
  copyProvenance(labels, *selected);
  selected->setName(labels.getName());
  auto tile = labels.tree().cbeginValueOn();
  tile.setMaxDepth(Int32Tree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    if (!wanted.holds(*tile)) continue;
    selected->tree().sparseFill(tile.getBoundingBox(), *tile, true);
    wanted.find(*tile);
  }

  const auto leaves = detail::leavesOf(labels.tree());
  std::vector<std::unique_ptr<Leaf>> parts(leaves.size());
  detail::parallelForEach(leaves.size(), detail::kLeafGrain, interrupter,
                          [&](size_t n) { parts[n] = wantedPart(*leaves[n], wanted); });
  for (std::unique_ptr<Leaf>& part : parts) {
    if (!part) continue;
    for (auto voxel = part->cbeginValueOn(); voxel; ++voxel) wanted.find(*voxel);
    selected->tree().addLeaf(part.release());
  }
  wanted.checkAllFound();
  return selected;
}

}  // namespace vdb_madf
