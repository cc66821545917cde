// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/method/manifold_graph.h"

namespace vdb_madf::detail {

/// The weakest neck among manifolds that are one grain, or a part of one. Joined by their edges in
/// descending order of saddle height (then by ascending pair) until they are one, they leave a
/// spanning tree. An edge that joined the classes a and b at height h is narrower than these by
/// sqrt(min(top(a), top(b))) - sqrt(h), top being the largest D of a class. The weakest neck is the
/// edge where that is most (then the lower one, then the later one), of those that leave voxels on
/// both sides.
/// @param nodes of the graph, ascending; where no edges join them all, they are joined at height 0
/// @param voxels of each of them
/// @return of each node, whether it lies on the other side than that of largest D (then of the
///   smaller coordinate); absent if no edge leaves voxels on both sides
std::optional<std::vector<char>> beyondWeakestNeck(const ManifoldGraph& graph,
                                                   const std::vector<uint32_t>& nodes,
                                                   const std::vector<int64_t>& voxels);

}  // namespace vdb_madf::detail
