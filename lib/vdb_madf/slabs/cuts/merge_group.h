// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_madf/grids/grid_types.h"
#include "vdb_madf/method/detail/merge_rule.h"

namespace vdb_madf::detail {

/// A part of the graph that merge() is about, as far as it is not decided: classes of critical
/// points that are merged already, and edges that may merge more of them.
struct MergeGroup {
  struct Class {
    int32_t top = 0;      ///< the largest D, of what the group knows
    bool isOpen = false;  ///< may other groups have edges of it?
  };
  struct Edge {
    uint32_t first, second;  ///< classes
    int32_t height;          ///< of the saddle, > 0; or kCertain
    Coord lower, upper;  ///< the two critical points, lower < upper: edges of one height go by them
  };
  std::vector<Class> classes;
  std::vector<Edge> edges;  ///< a pair may have several

  /// The height of an edge that merges whatever the tops are: by the angle, or as its ends are
  /// known to be of one class. (A neck of that height does, too.)
  static constexpr int32_t kCertain = std::numeric_limits<int32_t>::max();
};

/// Merges all classes of which it is certain that merge() merges them, and drops all edges that do
/// not matter for what is left. Two groups are joined by putting them side by side, with an edge
/// kCertain between the classes of each critical point that is in both. In whatever order all edges
/// of a graph have come together: once no class is open, no edge is left, and the classes are those
/// of merge(). README.md says why.
/// @return the class of each one that there was; classes are numbered as the first of those in them
///   was
std::vector<uint32_t> contract(MergeGroup& group, const MergeRule& rule);

}  // namespace vdb_madf::detail
