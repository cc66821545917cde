// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <vector>

#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf::test {

/// Labels cut into slabs at multiples of 8, as if each were read from a file.
inline LabelSlabs inSlabs(const Int32Grid::Ptr& labels, const std::vector<int>& cuts) {
  LabelSlabs slabs;
  slabs.cuts = cuts;
  slabs.about = Int32Grid::create(*labels);  // its metadata and transform
  slabs.read = [labels, cuts](size_t slab, Interrupter*) {
    const auto part = Int32Grid::create(0);
    for (auto voxel = labels->cbeginValueOn(); voxel; ++voxel) {
      CoordBBox box = voxel.getBoundingBox();
      box.min().z() = std::max(box.min().z(), cuts[slab]);
      box.max().z() = std::min(box.max().z(), cuts[slab + 1] - 1);
      if (!box.empty()) part->denseFill(box, *voxel);
    }
    return part;
  };
  return slabs;
}

}  // namespace vdb_madf::test
