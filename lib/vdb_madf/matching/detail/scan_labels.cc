// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/matching/detail/scan_labels.h"

#include <limits>
#include <memory>

#include "vdb_madf/labels/detail/label_blocks.h"

namespace vdb_madf::detail {

ScanLabels::ScanLabels(const Int32Grid& labels) : whole_(withoutTiles(labels)) {}

ScanLabels::ScanLabels(const AnyLabels& labels) {
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&labels))
    whole_ = withoutTiles(**whole);
  else
    slabs_ = &std::get<LabelSlabs>(labels);
}

void ScanLabels::forEachPart(int margin, Interrupter* interrupter,
                             const std::function<void(const Part&)>& f) {
  if (whole_) {
    f({whole_, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()});
    return;
  }
  for (size_t slab = 0; slab < slabs_->slabCount(); ++slab) {
    const int low = slabs_->cuts[slab], high = slabs_->cuts[slab + 1];
    f({layers(low - margin, high - 1 + margin, interrupter), low, high});
  }
}

Int32Tree::ConstPtr ScanLabels::layers(int low, int high, Interrupter* interrupter) {
  if (whole_) return whole_;
  const auto tree = std::make_shared<Int32Tree>(0);
  for (size_t slab = 0; slab < slabs_->slabCount(); ++slab) {
    if (slabs_->cuts[slab + 1] <= low || slabs_->cuts[slab] > high) {
      read_.erase(slab);
      continue;
    }
    Int32Tree::ConstPtr& labels = read_[slab];
    if (!labels) labels = withoutTiles(*slabs_->read(slab, interrupter));
    for (auto leaf = labels->cbeginLeaf(); leaf; ++leaf)
      if (const int z = leaf->origin().z(); z + 8 > low && z <= high)
        tree->addLeaf(new Int32Tree::LeafNodeType(*leaf));
  }
  return tree;
}

}  // namespace vdb_madf::detail
