// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstddef>
#include <functional>
#include <variant>
#include <vector>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"

namespace vdb_madf {

/// Labels that are cut into slabs along z, which need not fit in memory together.
struct LabelSlabs {
  /// Slab s is cuts[s] <= z < cuts[s + 1]: multiples of 8, ascending.
  std::vector<int> cuts;
  /// The labels in a slab; none lies outside of it. Called more than once. Who reads may turn tiles
  /// of the grid into leaf nodes.
  std::function<Int32Grid::Ptr(size_t slab, Interrupter* interrupter)> read;
  /// Its name, transform and metadata are those of the labels; it has no voxels.
  Int32Grid::ConstPtr about;

  size_t slabCount() const { return cuts.empty() ? 0 : cuts.size() - 1; }
};

/// Labels that are in memory as a single slab, for functions that take slabs.
LabelSlabs singleSlab(const Int32Grid::Ptr& labels);

/// Labels in memory, or in slabs.
using AnyLabels = std::variant<Int32Grid::ConstPtr, LabelSlabs>;
/// A grid of their name, transform and metadata.
const Int32Grid& aboutOf(const AnyLabels& labels);
inline const Int32Grid& aboutOf(const Int32Grid& labels) {
  return labels;
}
inline const Int32Grid& aboutOf(const LabelSlabs& labels) {
  return *labels.about;
}
/// f(labels), of either kind: const Int32Grid& or const LabelSlabs&.
template <typename F>
auto applied(const AnyLabels& labels, const F& f) {
  if (const auto* const whole = std::get_if<Int32Grid::ConstPtr>(&labels)) return f(**whole);
  return f(std::get<LabelSlabs>(labels));
}

}  // namespace vdb_madf
