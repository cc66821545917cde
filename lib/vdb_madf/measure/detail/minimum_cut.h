// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdb_madf::detail {

/// An undirected edge that is cut at a cost.
struct CutEdge {
  std::array<uint32_t, 2> nodes;
  int64_t cost;  ///< above 0
};

/// The minimum cut between two sets of nodes, by maximum flow; of several that with the
/// fewest nodes on the side of the sources.
/// @return of each node whether it is on that side
/// @pre no source is a sink; the sum of all costs is below 2^62
std::vector<bool> minimumCut(size_t nodes, const std::vector<CutEdge>& edges,
                             const std::vector<uint32_t>& sources,
                             const std::vector<uint32_t>& sinks);

}  // namespace vdb_madf::detail
