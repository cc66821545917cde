// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Labels that are cut into slabs along z, which need not fit in memory together.
struct LabelSlabs {
  /// Slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8, ascending.
  std::vector<int> cuts;
  /// The labels in a slab; none lies outside of it. Called more than once.
  std::function<Int32Grid::Ptr(size_t slab, Interrupter* interrupter)> read;
  /// Its name, transform and metadata are those of the labels; it has no voxels.
  Int32Grid::ConstPtr about;

  size_t slabCount() const { return cuts.empty() ? 0 : cuts.size() - 1; }
};

/// Labels that are in memory as a single slab, for functions that take slabs.
inline LabelSlabs singleSlab(const Int32Grid::Ptr& labels) {
  LabelSlabs slabs;
  const CoordBBox box = labels->evalActiveVoxelBoundingBox();
  slabs.cuts = {0, 8};
  if (!labels->empty() && !box.empty()) slabs.cuts = {box.min().z() & ~7, (box.max().z() | 7) + 1};
  slabs.read = [labels](size_t, Interrupter*) { return labels; };
  slabs.about = labels;
  return slabs;
}

}  // namespace vdb_madf
