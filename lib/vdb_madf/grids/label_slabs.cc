// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/grids/label_slabs.h"

namespace vdb_madf {

LabelSlabs singleSlab(const Int32Grid::Ptr& labels) {
  LabelSlabs slabs;
  const CoordBBox box = labels->evalActiveVoxelBoundingBox();
  slabs.cuts = {0, 8};
  if (!labels->empty() && !box.empty()) slabs.cuts = {box.min().z() & ~7, (box.max().z() | 7) + 1};
  slabs.read = [labels](size_t, Interrupter*) { return labels; };
  slabs.about = labels->copyWithNewTree();
  return slabs;
}

const Int32Grid& aboutOf(const AnyLabels& labels) {
  const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&labels);
  return whole ? **whole : *std::get<LabelSlabs>(labels).about;
}

}  // namespace vdb_madf
