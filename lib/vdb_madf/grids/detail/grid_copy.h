// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/openvdb.h>

namespace vdb_madf::detail {

/// A grid with a tree, a transform and metadata of its own. In place of Grid::deepCopy(), which some
/// compilers take inline, and then miss the constructor that it calls (grid_instances.h).
template <typename Grid>
typename Grid::Ptr deepCopyOf(const Grid& grid) {
  const openvdb::GridBase& any = grid;
  return openvdb::gridPtrCast<Grid>(any.deepCopyGrid());
}

}  // namespace vdb_madf::detail
