// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include "vdb_madf/grids/grid_types.h"

// OpenVDB's topologyIntersection() and topologyDifference() turn tiles off and leave them the value
// `true`: who copies the values of such a mask takes them for voxels. These leave none.

namespace vdb_madf::detail {

/// Gives tiles that are off the value of background.
inline void clearTilesOff(MaskTree& mask) {
  auto tile = mask.beginValueOff();
  tile.setMaxDepth(MaskTree::ValueOffIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) tile.setValue(false);
}

/// Keeps the voxels that the other tree has, too.
inline void intersect(MaskTree& mask, const MaskTree& other) {
  mask.topologyIntersection(other);
  clearTilesOff(mask);
}

/// Keeps the voxels that the other tree does not have.
inline void subtract(MaskTree& mask, const MaskTree& other) {
  mask.topologyDifference(other);
  clearTilesOff(mask);
}

}  // namespace vdb_madf::detail
