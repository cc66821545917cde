// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/slab_part.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/method/detail/reduce_edges.h"

namespace vdb_madf::detail {

namespace {

using Edge = ManifoldGraph::Edge;

/// Ascending, each once, without voxels.
std::vector<CriticalPoint> sortedNodes(std::vector<CriticalPoint> nodes) {
  std::sort(nodes.begin(), nodes.end(),
            [](const CriticalPoint& a, const CriticalPoint& b) { return a.position < b.position; });
  const auto end = std::unique(
      nodes.begin(), nodes.end(),
      [](const CriticalPoint& a, const CriticalPoint& b) { return a.position == b.position; });
  nodes.erase(end, nodes.end());
  for (CriticalPoint& node : nodes) node.voxels = node.cavityVoxels = 0;
  return nodes;
}

/// The node at a position, which there is.
uint32_t nodeAt(const ManifoldGraph& graph, const Coord& position) {
  const auto found =
      std::lower_bound(graph.nodes.begin(), graph.nodes.end(), position,
                       [](const CriticalPoint& a, const Coord& p) { return a.position < p; });
  return uint32_t(found - graph.nodes.begin());
}

}  // namespace

std::vector<SlabRoot> slabRoots(size_t slab, const std::vector<CriticalPoint>& points,
                                const std::vector<uint32_t>& numbers,
                                const std::vector<SlabLead>& leads) {
  std::vector<SlabRoot> roots;
  roots.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i)
    roots.push_back(
        {points[i], numbers.empty() ? 0 : numbers[i], uint32_t(slab), uint32_t(slab), true});
  for (const SlabLead& lead : leads) {
    SlabRoot& root = roots[lead.terminal];
    // A ball that is critical is the terminal of its own voxel: it is one, whoever asks.
    const bool isTerminal = root.point.position == lead.root.point.position;
    root = lead.root;
    root.isTerminal = isTerminal;
  }
  return roots;
}

SlabPart slabPart(size_t slab, const SlabTerminals& terminals, const std::vector<SlabRoot>& roots,
                  const std::vector<Edge>& contacts, const std::vector<SlabRoot>& below,
                  const std::vector<uint32_t>& above) {
  SlabPart part;
  ManifoldGraph& graph = part.graph;
  std::vector<CriticalPoint> nodes;
  for (const SlabRoot& root : roots) nodes.push_back(root.point);
  for (const SlabRoot& root : below) nodes.push_back(root.point);
  graph.nodes = sortedNodes(std::move(nodes));

  part.number.assign(graph.nodes.size(), 0);
  part.goesOn.assign(graph.nodes.size(), 0);
  part.startsBelow.assign(graph.nodes.size(), 0);
  const auto nodesOf = [&](const std::vector<SlabRoot>& some) {
    std::vector<uint32_t> result;
    result.reserve(some.size());
    for (const SlabRoot& root : some) {
      const uint32_t node = nodeAt(graph, root.point.position);
      part.number[node] = root.number;
      if (root.first < slab) part.startsBelow[node] = 1;
      if (root.last > slab) part.goesOn[node] = 1;
      result.push_back(node);
    }
    return result;
  };
  part.nodeOf = nodesOf(roots);
  const std::vector<uint32_t> nodeBelow = nodesOf(below);
  // The next part has these contacts.
  for (const uint32_t terminal : above) part.goesOn[part.nodeOf[terminal]] = 1;
  for (size_t i = 0; i < roots.size(); ++i) {
    graph.nodes[part.nodeOf[i]].voxels += terminals.points[i].voxels;
    graph.nodes[part.nodeOf[i]].cavityVoxels += terminals.points[i].cavityVoxels;
  }

  const auto addEdge = [&](Edge edge, uint32_t a, uint32_t b, bool areTerminals) {
    if (a == b) return;
    edge.first = std::min(a, b);
    edge.second = std::max(a, b);
    edge.cellsTouch = edge.cellsTouch && areTerminals;
    graph.edges.push_back(edge);
  };
  for (const Edge& edge : terminals.edges)
    addEdge(edge, part.nodeOf[edge.first], part.nodeOf[edge.second],
            roots[edge.first].isTerminal && roots[edge.second].isTerminal);
  for (const Edge& edge : contacts)
    addEdge(edge, nodeBelow[edge.first], part.nodeOf[edge.second],
            below[edge.first].isTerminal && roots[edge.second].isTerminal);
  reduceEdges(graph.edges);
  return part;
}

}  // namespace vdb_madf::detail
