// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/edits/detail/weakest_neck.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/sorted.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;

/// An edge of the spanning tree, between places in the list of nodes.
struct Neck {
  uint32_t first = 0, second = 0;
  int32_t height = 0;
  double narrower = 0;
};

/// The edges between nodes of the list, as necks.
std::vector<Neck> necksWithin(const ManifoldGraph& graph, const std::vector<uint32_t>& nodes) {
  std::vector<Neck> necks;
  for (uint32_t place = 0; place < nodes.size(); ++place) {
    auto edge = std::lower_bound(graph.edges.begin(), graph.edges.end(), nodes[place],
                                 [](const Edge& e, uint32_t node) { return e.first < node; });
    for (; edge != graph.edges.end() && edge->first == nodes[place]; ++edge)
      if (const auto other = findSorted(nodes, edge->second))
        necks.push_back({place, uint32_t(*other), std::max(edge->saddleHeight, 0)});
  }
  return necks;
}

/// The necks in the order in which they join.
std::vector<Neck> spanningTree(const ManifoldGraph& graph, const std::vector<uint32_t>& nodes) {
  std::vector<Neck> necks = necksWithin(graph, nodes);
  std::stable_sort(necks.begin(), necks.end(),
                   [](const Neck& a, const Neck& b) { return a.height > b.height; });
  for (uint32_t place = 1; place < nodes.size(); ++place) necks.push_back({0, place});
  DisjointSets classes(nodes.size());
  std::vector<int32_t> top;  // largest D of a class, at its root
  for (const uint32_t node : nodes) top.push_back(graph.nodes[node].squaredRadius);
  std::vector<Neck> tree;
  for (Neck neck : necks) {
    const uint32_t a = classes.find(neck.first), b = classes.find(neck.second);
    if (a == b) continue;
    neck.narrower = std::sqrt(double(std::min(top[a], top[b]))) - std::sqrt(double(neck.height));
    tree.push_back(neck);
    const int32_t larger = std::max(top[a], top[b]);
    classes.unite(a, b);
    top[classes.find(a)] = larger;
  }
  return tree;
}

/// The tree from a root on.
class RootedTree {
 public:
  RootedTree(const std::vector<Neck>& tree, uint32_t root) : parent_(tree.size() + 1, root) {
    std::vector<uint32_t> first(tree.size() + 2, 0), next(2 * tree.size());
    for (const Neck& neck : tree) ++first[neck.first + 1], ++first[neck.second + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<uint32_t> end(first.begin(), first.end() - 1);
    for (const Neck& neck : tree) {
      next[end[neck.first]++] = neck.second;
      next[end[neck.second]++] = neck.first;
    }
    order_.push_back(root);
    for (size_t i = 0; i < order_.size(); ++i)
      for (uint32_t n = first[order_[i]]; n < first[order_[i] + 1]; ++n)
        if (next[n] != parent_[order_[i]]) {
          parent_[next[n]] = order_[i];
          order_.push_back(next[n]);
        }
  }

  /// The end of an edge that is farther from the root.
  uint32_t below(const Neck& neck) const {
    return parent_[neck.second] == neck.first ? neck.second : neck.first;
  }
  /// The sums of a place and all places below it.
  std::vector<int64_t> sums(std::vector<int64_t> values) const {
    for (size_t i = order_.size(); i-- > 1;) values[parent_[order_[i]]] += values[order_[i]];
    return values;
  }
  /// Whether it is `place` or below it, of each place.
  std::vector<char> from(uint32_t place) const {
    std::vector<char> is(parent_.size(), 0);
    is[place] = 1;
    for (size_t i = 1; i < order_.size(); ++i)
      if (is[parent_[order_[i]]]) is[order_[i]] = 1;
    return is;
  }

 private:
  std::vector<uint32_t> parent_;  // the root is its own
  std::vector<uint32_t> order_;   // parents come before what is below them
};

}  // namespace

std::optional<std::vector<char>> beyondWeakestNeck(const ManifoldGraph& graph,
                                                   const std::vector<uint32_t>& nodes,
                                                   const std::vector<int64_t>& voxels) {
  if (nodes.empty()) return std::nullopt;
  uint32_t largest = 0;
  for (uint32_t i = 1; i < nodes.size(); ++i)
    if (graph.nodes[nodes[i]].squaredRadius > graph.nodes[nodes[largest]].squaredRadius)
      largest = i;
  const std::vector<Neck> necks = spanningTree(graph, nodes);
  const RootedTree tree(necks, largest);
  const std::vector<int64_t> below = tree.sums(voxels);
  const Neck* weakest = nullptr;
  for (const Neck& neck : necks) {
    const int64_t beyond = below[tree.below(neck)];
    if (beyond == 0 || beyond == below[largest]) continue;
    if (!weakest ||
        std::tuple(neck.narrower, -neck.height) >= std::tuple(weakest->narrower, -weakest->height))
      weakest = &neck;
  }
  if (!weakest) return std::nullopt;
  return tree.from(tree.below(*weakest));
}

}  // namespace vdb_madf::detail
