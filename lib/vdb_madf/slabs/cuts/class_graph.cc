// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/cuts/class_graph.h"

#include <algorithm>
#include <utility>

#include "vdb_madf/method/detail/reduce_edges.h"

namespace vdb_madf::detail {

ClassGraph classGraph(const SlabPart& part, const std::vector<uint32_t>& classOfNode) {
  ClassGraph graph;
  std::vector<ClassGraph::Size>& sizes = graph.sizes;
  for (size_t i = 0; i < classOfNode.size(); ++i) {
    const CriticalPoint& node = part.graph.nodes[i];
    sizes.push_back({classOfNode[i], node.squaredRadius, node.squaredRadius - node.doubt,
                     node.voxels, node.cavityVoxels});
  }
  std::sort(sizes.begin(), sizes.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
  size_t count = 0;
  for (const ClassGraph::Size& size : sizes) {
    if (count == 0 || sizes[count - 1].number != size.number) {
      sizes[count++] = size;
      continue;
    }
    ClassGraph::Size& all = sizes[count - 1];
    all.top = std::max(all.top, size.top);
    all.sure = std::max(all.sure, size.sure);
    all.voxels += size.voxels;
    all.cavityVoxels += size.cavityVoxels;
  }
  sizes.resize(count);
  for (ManifoldGraph::Edge edge : part.graph.edges) {
    const auto [first, second] = std::minmax(classOfNode[edge.first], classOfNode[edge.second]);
    if (first == second) continue;
    graph.contacts.push_back({first, second, edge.contactFaces, edge.saddleHeight, false});
  }
  reduceEdges(graph.contacts);
  return graph;
}

JoinedClasses::JoinedClasses(const std::vector<Coord>& representatives) {
  graph_.nodes.reserve(representatives.size());
  for (const Coord& position : representatives) graph_.nodes.push_back({position, 0, 0});
}

void JoinedClasses::add(const ClassGraph& part) {
  for (const ClassGraph::Size& size : part.sizes) {
    CriticalPoint& all = graph_.nodes[size.number];
    const int32_t sure = std::max(all.squaredRadius - all.doubt, size.sure);
    all.squaredRadius = std::max(all.squaredRadius, size.top);
    all.doubt = all.squaredRadius - sure;
    all.voxels += size.voxels;
    all.cavityVoxels += size.cavityVoxels;
  }
  graph_.edges.insert(graph_.edges.end(), part.contacts.begin(), part.contacts.end());
}

ManifoldGraph JoinedClasses::finish(const VoxelWeights& weights,
                                    const std::optional<int>& flatAxis) {
  graph_.weights = weights;
  graph_.flatAxis = flatAxis;
  reduceEdges(graph_.edges);
  return std::move(graph_);
}

}  // namespace vdb_madf::detail
