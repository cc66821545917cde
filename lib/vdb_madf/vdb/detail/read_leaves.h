// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <openvdb/Grid.h>

#include <istream>

#include "vdb_madf/vdb/detail/vdb_tree_check.h"

namespace vdb_madf::detail {

/// Reads the leaf buffers of a grid whose topology has been read, on all threads, as the grid's
/// readBuffers() would on one; other types than Int32 and Float are left to that. `stream` reads
/// from `file`, whose position is the end of the topology, and has the state that OpenVDB's readers
/// ask for.
/// @throw what OpenVDB throws for damaged values; std::runtime_error if they do not end where
///   `extent` says.
void readLeaves(InputBuffer& file, std::istream& stream, const TreeExtent& extent,
                openvdb::GridBase& grid);

}  // namespace vdb_madf::detail
