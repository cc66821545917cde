// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/graph_part.h"

#include <algorithm>
#include <string>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/detail/reduce_edges.h"

namespace vdb_madf {

ManifoldGraph joinedGraph(const std::vector<GraphPart>& parts) {
  size_t most = 0;
  for (const GraphPart& part : parts) most += part.number.size();
  size_t count = 0;
  for (const GraphPart& part : parts)
    if (!part.number.empty()) count = std::max<size_t>(count, part.number.back());
  const auto fail = [](size_t number, const std::string& what) {
    throw InvalidInput("the parts of the graph are not of one: manifold " + std::to_string(number) +
                       what + ": segment again");
  };
  if (count > most) fail(count, " is one of too few");
  ManifoldGraph whole;
  whole.nodes.resize(count);
  std::vector<char> isKnown(count, 0);
  for (const GraphPart& part : parts) {
    whole.weights = part.graph.weights;
    whole.flatAxis = part.graph.flatAxis;
    for (size_t i = 0; i < part.number.size(); ++i) {
      const size_t at = part.number[i] - 1;
      const ManifoldGraph::Node& node = part.graph.nodes[i];
      ManifoldGraph::Node& all = whole.nodes[at];
      if (!isKnown[at])
        all = {node.position, node.squaredRadius, 0, 0, node.doubt};
      else if (all.position != node.position || all.squaredRadius != node.squaredRadius)
        fail(at + 1, " is another one in another part");
      isKnown[at] = 1;
      all.voxels += node.voxels;
      all.cavityVoxels += node.cavityVoxels;
    }
    for (ManifoldGraph::Edge edge : part.graph.edges) {
      edge.first = part.number[edge.first] - 1;
      edge.second = part.number[edge.second] - 1;
      whole.edges.push_back(edge);
    }
  }
  for (size_t at = 0; at < count; ++at)
    if (!isKnown[at]) fail(at + 1, " is in none");
  detail::reduceEdges(whole.edges);
  return whole;
}

}  // namespace vdb_madf
