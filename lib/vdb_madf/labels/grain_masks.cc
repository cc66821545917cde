// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/grain_masks.h"

#include <map>

#include "vdb_madf/base/detail/bits.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/labels/detail/label_leaves.h"
#include "vdb_madf/labels/grain_name.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf {

namespace {

using BoolLeaf = BoolGrid::TreeType::LeafNodeType;

class GrainMasks {
 public:
  explicit GrainMasks(const Int32Grid& labels) : labels_(labels) {}

  BoolLeaf& leaf(int32_t label, const Coord& origin) {
    BoolGrid::Ptr& grid = grids_[label];
    if (!grid) {
      if (grids_.size() > kMaxGrainGrids)
        throw InvalidInput("there are more grains than files should have grids (at most " +
                           std::to_string(kMaxGrainGrids) + "): export the labels, or a preview");
      grid = BoolGrid::create(false);
      copyProvenance(labels_, *grid);
      grid->setName(grainName(label));
    }
    return *grid->tree().touchLeaf(origin);
  }

  std::vector<BoolGrid::Ptr> grids() const {
    std::vector<BoolGrid::Ptr> result;
    for (const auto& [label, grid] : grids_) result.push_back(grid);
    return result;
  }

 private:
  const Int32Grid& labels_;
  std::map<int32_t, BoolGrid::Ptr> grids_;
};

}  // namespace

std::vector<BoolGrid::Ptr> grainMasks(const Int32Grid& labels, Interrupter* interrupter) {
  const detail::LabelLeaves leaves(labels, interrupter);
  const LeafIndex& index = leaves.index();
  GrainMasks masks(labels);
  for (size_t n = 0; n < index.leafCount(); ++n) {
    if (interrupter && interrupter->wasInterrupted(int(100 * n / index.leafCount())))
      throw Interrupted();
    for (const detail::LabelPart& part : leaves.parts(n)) {
      BoolLeaf& leaf = masks.leaf(part.label, index.origin(n));
      for (size_t x = 0; x < 8; ++x)
        detail::forEachBit(part.mask[x], [&](int bit) {
          leaf.setValueOn(openvdb::Index(x * 64 + size_t(bit)), true);
        });
    }
  }
  return masks.grids();
}

}  // namespace vdb_madf
