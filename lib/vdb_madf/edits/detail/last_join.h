// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vdb_madf/method/hierarchy.h"

namespace vdb_madf::detail {

/// The two sides of the last join of a hierarchy that made manifolds, which are one grain or a part
/// of one, what they are: both sides have voxels of theirs.
/// @param nodes of the graph, ascending
/// @param voxels of each of them
/// @return as beyondWeakestNeck(); what has no voxels and came later lies with the largest D.
///   Absent if no join did, or if it left voxels apart.
std::optional<std::vector<char>> beyondLastJoin(const ManifoldGraph& graph,
                                                const Hierarchy& hierarchy,
                                                const std::vector<uint32_t>& nodes,
                                                const std::vector<int64_t>& voxels);

}  // namespace vdb_madf::detail
