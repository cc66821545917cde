// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "support/catch.h"
#include "vdb_madf/method/manifold_graph.h"

// The weakest neck of a grain, found slowly.

namespace vdb_madf::test {

/// By the definition: classes as sets, tops looked up anew, sides by walking.
inline std::optional<std::vector<char>> naiveNeck(const ManifoldGraph& graph,
                                                  const std::vector<uint32_t>& nodes,
                                                  const std::vector<int64_t>& voxels) {
  struct Link {
    size_t a, b;
    int height, order;
    double narrower;
  };
  const auto place = [&](uint32_t node) {
    return size_t(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  std::vector<Link> links;
  for (const auto& edge : graph.edges)
    if (place(edge.first) < nodes.size() && place(edge.second) < nodes.size())
      links.push_back({place(edge.first), place(edge.second), std::max(0, edge.saddleHeight),
                       int(links.size()), 0});
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
    return a.height != b.height ? a.height > b.height : a.order < b.order;
  });
  std::vector<std::set<size_t>> classes;
  for (size_t i = 0; i < nodes.size(); ++i) classes.push_back({i});
  const auto top = [&](const std::set<size_t>& members) {
    int largest = 0;
    for (const size_t i : members) largest = std::max(largest, graph.nodes[nodes[i]].squaredRadius);
    return largest;
  };
  std::vector<Link> tree;
  for (Link link : links) {
    const auto with = [&](size_t i) {
      return std::find_if(classes.begin(), classes.end(),
                          [&](const auto& c) { return c.count(i); });
    };
    if (with(link.a) == with(link.b)) continue;
    const std::set<size_t> a = *with(link.a), b = *with(link.b);
    link.narrower = std::sqrt(double(std::min(top(a), top(b)))) - std::sqrt(double(link.height));
    tree.push_back(link);
    with(link.a)->insert(b.begin(), b.end());
    classes.erase(std::find(classes.begin(), classes.end(), b));
  }
  REQUIRE(classes.size() == 1);
  size_t largest = 0;
  for (size_t i = 1; i < nodes.size(); ++i)
    if (graph.nodes[nodes[i]].squaredRadius > graph.nodes[nodes[largest]].squaredRadius)
      largest = i;
  std::optional<std::vector<char>> best;
  double most = 0;
  int lowest = 0;
  for (size_t without = 0; without < tree.size(); ++without) {
    std::vector<char> beyond(nodes.size(), 1);
    beyond[largest] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (size_t i = 0; i < tree.size(); ++i) {
        if (i == without || beyond[tree[i].a] == beyond[tree[i].b]) continue;
        beyond[tree[i].a] = beyond[tree[i].b] = 0;
        changed = true;
      }
    }
    int64_t here = 0, there = 0;
    for (size_t i = 0; i < nodes.size(); ++i) (beyond[i] ? there : here) += voxels[i];
    if (here == 0 || there == 0) continue;
    const Link& link = tree[without];
    if (best && (link.narrower < most || (link.narrower == most && link.height > lowest))) continue;
    best = beyond;
    most = link.narrower;
    lowest = link.height;
  }
  return best;
}

}  // namespace vdb_madf::test
