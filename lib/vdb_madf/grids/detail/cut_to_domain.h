// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/tools/Prune.h>

#include "vdb_madf/grids/grid_metadata.h"

namespace vdb_madf::detail {

/// Takes from a grid what lies outside of a domain, which is its own then. Values of inactive
/// voxels stay.
template <typename Grid>
void cutToDomain(const Domain& domain, Grid& grid) {
  auto& tree = grid.tree();
  CoordBBox active;
  if (tree.evalActiveVoxelBoundingBox(active) && !domain.box().isInside(active))
    tree.clip(domain.box());
  if (!domain.isBox()) {
    tree.topologyIntersection(*domain.region());
    openvdb::tools::pruneInactive(tree);
  }
  setDomain(grid, domain);
}

}  // namespace vdb_madf::detail
