// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/leaves/leaf_index.h"
#include "vdb_madf/method/manifold_graph.h"
#include "vdb_madf/method/merge.h"
#include "vdb_madf/method/tidy.h"

namespace vdb_madf::detail {

/// The voxels of a grid of manifolds.
LeafIndex topologyOf(const Int32Grid& manifold);

/// The node of each voxel of a grid of manifolds, active tiles included.
/// @param numbers the numbers of the nodes in the grid, ascending
/// @throw InvalidInput if the grid does not fit the graph; Interrupted
VoxelArray<uint32_t> nodesOf(const Int32Grid& manifold, const LeafIndex& index,
                             const ManifoldGraph& graph, const std::vector<uint32_t>& numbers,
                             Interrupter* interrupter);

/// The grains of a merging on the voxels of a grid of manifolds, active tiles included, before they
/// are tidied. @throw InvalidInput if the grid does not fit the graph; Interrupted
GrainLabels labelGrains(const Int32Grid& manifold, const LeafIndex& index,
                        const ManifoldGraph& graph, const Merging& merging,
                        Interrupter* interrupter);

/// The grains of a merging, without labels of voxels yet.
GrainLabels grainsOf(const ManifoldGraph& graph, const Merging& merging);

}  // namespace vdb_madf::detail
