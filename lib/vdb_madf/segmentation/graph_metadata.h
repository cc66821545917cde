// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "vdb_madf/base/interrupter.h"
#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/grids/label_slabs.h"
#include "vdb_madf/segmentation/graph_part.h"

namespace vdb_madf {

/// The manifold graph of a grid: one binary metadata value, `madf_manifold_graph`, of a type of the
/// same name that initialize() registers. Programs that do not know the type skip it.
///
/// The value, in bytes, all integers little-endian: version 1 (u32), number of nodes (u32), number
/// of edges (u32); per node x, y, z, squared radius (i32), voxels (i64); per edge first, second
/// (u32), contact faces (i64), saddle height (i32), cells touch (u8, 0 or 1). The graph's weights
/// stand beside it, in `madf_weights` (voxel_weights.h), its flat axis follows from the domain. The
/// part of a slab has version 2, and after the edges the number of each node (u32), then of each
/// whether it goes on (u8, 0 or 1).
/// Where a manifold has voxels in cavities, version 3 (of a part: 4) ends with their number for
/// each node (i64).
/// @throw InvalidInput if the graph breaks a rule of manifold_graph.h (order, ranges), or takes
///   4 GiB or more.
void setGraph(openvdb::GridBase& grid, ManifoldGraph graph);

/// Absent: the grid has no graph. @throw InvalidInput if it has a part of one alone, or
/// `madf_weights` cannot be those of the graph.
std::optional<ManifoldGraph> storedGraph(const openvdb::GridBase& grid);

/// The graph of a grid that has to have one. @throw InvalidInput as storedGraph(), and if there is
/// none
ManifoldGraph requiredGraph(const openvdb::GridBase& grid);

/// Removes the graph of a grid, or the part of one.
void removeGraph(openvdb::GridBase& grid);

/// Writes and reads the part of a slab, as setGraph() and storedGraph() do the whole.
void setGraphPart(openvdb::GridBase& grid, GraphPart part);
std::optional<GraphPart> storedGraphPart(const openvdb::GridBase& grid);
/// The graph of manifolds in slabs, each of which is read once. Absent: none of them has a part.
/// @throw InvalidInput if parts are not those of one graph; what reading throws
std::optional<ManifoldGraph> storedGraph(const LabelSlabs& manifolds, Interrupter* interrupter);

/// The metadata value.
constexpr char kGraphMetadata[] = "madf_manifold_graph";

}  // namespace vdb_madf
