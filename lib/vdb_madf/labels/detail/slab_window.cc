// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/labels/detail/slab_window.h"

#include <string>

#include "vdb_madf/base/errors.h"

namespace vdb_madf::detail {

LabelLeaves SlabWindow::leaves(const LeafLayers& layers, Interrupter* interrupter) {
  std::vector<const LabelLeaves*> parts;
  for (size_t s = 0; s < slabs_->slabCount(); ++s) {
    const int begin = slabs_->cuts[s], end = slabs_->cuts[s + 1];
    if (end <= layers.begin) read_.erase(s);
    if (end <= layers.begin || begin >= layers.end) continue;
    auto found = read_.find(s);
    if (found == read_.end()) {
      LabelLeaves read(*slabs_->read(s, interrupter), interrupter);
      const CoordBBox& box = read.index().boundingBox();
      if (read.index().voxelCount() > 0 && (box.min().z() < begin || box.max().z() >= end))
        throw InvalidInput("slab " + std::to_string(s + 1) + " of " +
                           std::to_string(slabs_->slabCount()) +
                           " has labels beyond its cuts: it is of other labels");
      found = read_.emplace(s, std::move(read)).first;
    }
    parts.push_back(&found->second);
  }
  return LabelLeaves(parts, layers);
}

}  // namespace vdb_madf::detail
