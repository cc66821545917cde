// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/merge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "vdb_madf/base/detail/disjoint_sets.h"
#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/merge_classes.h"
#include "vdb_madf/method/detail/merge_rule.h"
#include "vdb_madf/method/hierarchy.h"
#include "vdb_madf/method/join_small.h"

namespace vdb_madf {

namespace {

using Edge = ManifoldGraph::Edge;

constexpr size_t kEdgesPerChunk = 1 << 16;

void mergeByAngle(const ManifoldGraph& graph, const detail::MergeRule& rule,
                  detail::DisjointSets& grains) {
  for (const Edge& edge : graph.edges)
    if (rule.mergesByAngle(graph.nodes[edge.first], graph.nodes[edge.second], edge.cellsTouch))
      grains.unite(edge.first, edge.second);
}

void mergeByNeck(const ManifoldGraph& graph, const detail::MergeRule& rule,
                 detail::DisjointSets& grains) {
  constexpr int32_t kHighest = std::numeric_limits<int32_t>::max();
  std::vector<int32_t> top(graph.nodes.size(), 0);  // largest D of a class, at its root
  std::vector<uint32_t> root(graph.nodes.size());
  for (uint32_t i = 0; i < root.size(); ++i) {
    root[i] = grains.find(i);
    top[root[i]] = std::max(top[root[i]], graph.nodes[i].squaredRadius);
  }
  // By height from the largest on, then as edges are sorted: by their pair. Tops grow, so what does
  // not merge the classes as they are now never will.
  std::vector<uint64_t> order = detail::parallelCollect<uint64_t>(
      graph.edges.size(), kEdgesPerChunk, nullptr, [&](size_t i, std::vector<uint64_t>& some) {
        const Edge& edge = graph.edges[i];
        const int32_t smaller = std::min(top[root[edge.first]], top[root[edge.second]]);
        if (rule.seesNeck(edge.saddleHeight) && rule.mergesByNeck(edge.saddleHeight, smaller))
          some.push_back(uint64_t(kHighest - edge.saddleHeight) << 32 | i);
      });
  detail::parallelSort(order.begin(), order.end());
  for (const uint64_t next : order) {
    const Edge& edge = graph.edges[uint32_t(next)];
    const uint32_t a = grains.find(edge.first), b = grains.find(edge.second);
    if (a == b || !rule.mergesByNeck(edge.saddleHeight, std::min(top[a], top[b]))) continue;
    const int32_t merged = std::max(top[a], top[b]);
    grains.unite(a, b);
    top[grains.find(a)] = merged;
  }
}

}  // namespace

void checkMergeOptions(const MergeOptions& options) {
  if (!(options.theta >= -1 && options.theta <= 1))
    throw InvalidInput("theta is a cosine: it must lie between -1 and 1");
  if (options.delta < 0 || options.delta > kMaxDelta)
    throw InvalidInput("delta is in eighths of a voxel: it must lie between 0 and " +
                       std::to_string(kMaxDelta));
  if (!(std::abs(options.strictness) <= kMaxStrictness))
    throw InvalidInput("strictness is a score: it must lie between -200000 and 200000");
  if (options.minGrain < 0)
    throw InvalidInput("the least grain is a number of voxels: it must not be negative");
}

std::vector<uint32_t> detail::mergedClasses(const ManifoldGraph& graph,
                                            const MergeOptions& options) {
  DisjointSets grains(graph.nodes.size());
  const MergeRule rule(options, graph.weights);
  mergeByAngle(graph, rule, grains);
  mergeByNeck(graph, rule, grains);

  std::vector<uint32_t> classOfNode(graph.nodes.size());
  for (uint32_t i = 0; i < classOfNode.size(); ++i) classOfNode[i] = grains.find(i);
  return classOfNode;
}

Merging merge(const ManifoldGraph& graph, const MergeOptions& options) {
  checkMergeOptions(options);
  Merging merging = options.mode == MergeMode::score
                        ? cut(mergeHierarchy(graph, options.strictness), options.strictness)
                        : mergeClasses(graph, detail::mergedClasses(graph, options));
  if (options.minGrain > 0) merging = joinSmallGrains(graph, merging, options.minGrain);
  return merging;
}

Merging mergeClasses(const ManifoldGraph& graph, const std::vector<uint32_t>& classOfNode) {
  const auto count = uint32_t(graph.nodes.size());
  if (classOfNode.size() != count)
    throw InvalidInput("there are " + std::to_string(classOfNode.size()) + " classes for " +
                       std::to_string(count) + " manifolds");
  // Nodes are in lexicographic order, so the first of the largest is the representative.
  std::vector<uint32_t> best(size_t(count) + 1, count);
  std::vector<char> hasVoxels(size_t(count) + 1, 0);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t c = classOfNode[i];
    if (c > count)
      throw InvalidInput("manifold " + std::to_string(i + 1) + " has the class " +
                         std::to_string(c) + ": it must lie between 0 and " +
                         std::to_string(count));
    if (best[c] == count || graph.nodes[i].squaredRadius > graph.nodes[best[c]].squaredRadius)
      best[c] = i;
    if (graph.nodes[i].voxels > 0) hasVoxels[c] = 1;
  }
  Merging merging;
  std::vector<int32_t> grainOfClass(size_t(count) + 1, 0);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t c = classOfNode[i];
    if (best[c] != i || !hasVoxels[c]) continue;
    merging.representative.push_back(i);
    grainOfClass[c] = int32_t(merging.representative.size());
  }
  merging.grainOfNode.reserve(count);
  for (const uint32_t c : classOfNode) merging.grainOfNode.push_back(grainOfClass[c]);
  return merging;
}

std::vector<int64_t> grainVoxels(const ManifoldGraph& graph, const Merging& merging) {
  std::vector<int64_t> voxels(merging.representative.size(), 0);
  for (size_t i = 0; i < graph.nodes.size(); ++i)
    if (merging.grainOfNode[i] > 0)
      voxels[size_t(merging.grainOfNode[i] - 1)] += graph.nodes[i].voxels;
  return voxels;
}

}  // namespace vdb_madf
