// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/last_join.h"

#include <cstddef>
#include <numeric>

#include "vdb_madf/base/detail/disjoint_sets.h"

namespace vdb_madf::detail {

std::optional<std::vector<char>> beyondLastJoin(const ManifoldGraph& graph,
                                                const Hierarchy& hierarchy,
                                                const std::vector<uint32_t>& nodes,
                                                const std::vector<int64_t>& voxels) {
  if (nodes.empty()) return std::nullopt;
  const std::vector<Hierarchy::Join>& joins = hierarchy.joins;
  std::vector<int64_t> sums(hierarchy.classes.size(), 0);  // of the roots of sets
  uint32_t largest = nodes.front();
  for (size_t i = 0; i < nodes.size(); ++i) {
    sums[hierarchy.classOfNode[nodes[i]]] += voxels[i];
    if (graph.nodes[nodes[i]].squaredRadius > graph.nodes[largest].squaredRadius)
      largest = nodes[i];
  }
  const int64_t all = std::accumulate(sums.begin(), sums.end(), int64_t(0));
  DisjointSets sets(sums.size());
  const Hierarchy::Join* last = nullptr;
  int64_t joined = 0;  // voxels, by the last one
  for (const Hierarchy::Join& join : joins) {
    const uint32_t one = sets.find(join.first), other = sets.find(join.second);
    const bool isOfBoth = sums[one] > 0 && sums[other] > 0;
    const int64_t sum = sums[one] + sums[other];
    sets.unite(one, other);
    sums[sets.find(one)] = sum;
    if (!isOfBoth) continue;
    last = &join;
    joined = sum;
  }
  if (!last || joined < all) return std::nullopt;

  DisjointSets before(sums.size());
  for (const Hierarchy::Join* join = joins.data(); join != last; ++join)
    before.unite(join->first, join->second);
  const auto sideOf = [&](uint32_t node) { return before.find(hierarchy.classOfNode[node]); };
  const uint32_t second = before.find(last->second),
                 far = sideOf(largest) == second ? before.find(last->first) : second;
  std::vector<char> beyond;
  for (const uint32_t node : nodes) beyond.push_back(sideOf(node) == far);
  return beyond;
}

}  // namespace vdb_madf::detail
