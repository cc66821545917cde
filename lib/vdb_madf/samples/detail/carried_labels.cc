// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/samples/detail/carried_labels.h"

#include <openvdb/tools/Prune.h>
#include <openvdb/tree/ValueAccessor.h>

#include <algorithm>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/grids/detail/ball_steps.h"
#include "vdb_madf/grids/detail/leaf_nodes.h"
#include "vdb_madf/samples/detail/least_cells.h"

namespace vdb_madf::detail {

namespace {

/// 0 if no label is within reach.
template <typename Labels>
int32_t nearestLabel(const Labels& labels, const Coord& p,
                     const std::vector<std::pair<int, Coord>>& steps) {
  int32_t best = 0;
  int least = 0;
  for (const auto& [squared, step] : steps) {
    if (best > 0 && squared > least) break;
    const int32_t label = labels.getValue(p + step);
    if (label == 0 || (best > 0 && best < label)) continue;
    best = label;
    least = squared;
  }
  return best;
}

}  // namespace

Int32Tree::Ptr carriedLabels(const Int32Tree& labels, const MaskTree& object, int reach,
                             Interrupter* interrupter) {
  auto result = std::make_shared<Int32Tree>(object, 0, openvdb::TopologyCopy());
  const auto leaves = leavesOf(*result);
  const auto steps = ballSteps(reach);
  parallelFor(leaves.size(), 16, interrupter, [&](size_t begin, size_t end) {
    const openvdb::tree::ValueAccessor<const Int32Tree> known(labels);
    for (size_t i = begin; i < end; ++i)
      for (auto voxel = leaves[i]->beginValueOn(); voxel; ++voxel) {
        const int32_t label = nearestLabel(known, voxel.getCoord(), steps);
        voxel.setValue(label);
        if (label == 0) voxel.setValueOff();
      }
  });
  openvdb::tools::pruneInactive(*result);
  int32_t largest = 0;
  for (auto voxel = labels.cbeginValueOn(); voxel; ++voxel) largest = std::max(largest, *voxel);
  numberOwners(*result, size_t(largest), interrupter);
  return result;
}

}  // namespace vdb_madf::detail
