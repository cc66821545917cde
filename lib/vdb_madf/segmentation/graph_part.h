// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"

namespace vdb_madf {

/// Part of a graph whose voxels were cut into slabs: the critical points to which the voxels of a
/// slab flow, or that touch them from the slab below, wherever they lie; and the edges of pairs of
/// adjacent voxels of which the upper one, or the only one, is in the slab. A critical point has
/// the same position and D in all parts; voxels, faces, heights and cells are those of this part.
struct GraphPart {
  ManifoldGraph graph;
  /// The number of each node: 1 + its place in the graph of the whole, as in a grid of manifolds;
  /// ascending.
  std::vector<uint32_t> number;
  std::vector<char> goesOn;  ///< is each node in the part of a higher slab, too?
};

/// The graph that was cut: of all parts, in any order. @throw InvalidInput if they are not those of
/// one
ManifoldGraph joinedGraph(const std::vector<GraphPart>& parts);

}  // namespace vdb_madf
