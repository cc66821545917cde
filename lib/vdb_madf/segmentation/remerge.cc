// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/remerge.h"

#include <string>
#include <utility>

#include "vdb_madf/base/errors.h"
#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/segmentation/detail/manifold_labels.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"

namespace vdb_madf {

namespace {

void checkMerging(const ManifoldGraph& graph, const Merging& merging) {
  const auto& grainOfNode = merging.grainOfNode;
  const auto& representative = merging.representative;
  const auto fail = [](const std::string& what) {
    throw InvalidInput("the merging does not fit the graph of manifolds: " + what);
  };
  if (grainOfNode.size() != graph.nodes.size())
    fail("it has " + std::to_string(grainOfNode.size()) + " manifolds, the graph " +
         std::to_string(graph.nodes.size()));
  for (size_t i = 0; i < grainOfNode.size(); ++i) {
    const std::string name = "manifold " + std::to_string(i + 1);
    if (grainOfNode[i] < 0 || size_t(grainOfNode[i]) > representative.size())
      fail(name + " is in grain " + std::to_string(grainOfNode[i]) + " of " +
           std::to_string(representative.size()));
    if (grainOfNode[i] == 0 && graph.nodes[i].voxels > 0) fail(name + " is in no grain");
  }
  for (size_t g = 0; g < representative.size(); ++g)
    if (representative[g] >= grainOfNode.size() || size_t(grainOfNode[representative[g]]) != g + 1)
      fail("the representative of grain " + std::to_string(g + 1) + " is not one of its manifolds");
  const std::vector<int64_t> voxels = grainVoxels(graph, merging);
  for (size_t g = 0; g < voxels.size(); ++g)
    if (voxels[g] == 0) fail("grain " + std::to_string(g + 1) + " has no voxels");
}

/// The grains, with the metadata of the manifolds that do not concern their merging.
Int32Grid::Ptr mergedGrains(const Int32Grid& manifold, const ManifoldGraph& graph,
                            const Merging& merging, int tidyRounds, Interrupter* interrupter) {
  const LeafIndex index = detail::topologyOf(manifold);
  GrainLabels grains = detail::labelGrains(manifold, index, graph, merging, interrupter);
  tidy(index, tidyRounds, grains, interrupter);
  const Int32Grid::Ptr grain = toGrid(index, std::move(grains.label), "grain", interrupter);
  copyMetadata(manifold, *grain);
  removeGraph(*grain);
  return grain;
}

}  // namespace

Int32Grid::Ptr remerge(const Int32Grid& manifold, const MergeOptions& options, int tidyRounds,
                       Interrupter* interrupter) {
  checkMergeOptions(options);
  checkTidy(tidyRounds);
  const ManifoldGraph graph = requiredGraph(manifold);
  const Merging merging = merge(graph, options);
  const auto grain = mergedGrains(manifold, graph, merging, tidyRounds, interrupter);
  describeMerging(*grain, options, tidyRounds, int64_t(merging.representative.size()));
  return grain;
}

Int32Grid::Ptr applyMerging(const Int32Grid& manifold, const Merging& merging, int tidyRounds,
                            Interrupter* interrupter) {
  checkTidy(tidyRounds);
  const ManifoldGraph graph = requiredGraph(manifold);
  checkMerging(graph, merging);
  const auto grain = mergedGrains(manifold, graph, merging, tidyRounds, interrupter);
  describeOwnMerging(*grain, tidyRounds, int64_t(merging.representative.size()));
  return grain;
}

}  // namespace vdb_madf
