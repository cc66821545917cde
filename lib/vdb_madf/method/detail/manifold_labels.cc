// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/manifold_labels.h"

#include <string>
#include <vector>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/detail/voxels.h"

namespace vdb_madf::detail {

LeafIndex topologyOf(const Int32Grid& manifold) {
  MaskGrid object;
  object.setTree(std::make_shared<MaskTree>(manifold.tree(), true, openvdb::TopologyCopy()));
  return LeafIndex(object);
}

GrainLabels grainsOf(const ManifoldGraph& graph, const Merging& merging) {
  GrainLabels grains;
  grains.voxels = grainVoxels(graph, merging);
  grains.weights = graph.weights;
  grains.representative.reserve(merging.representative.size());
  for (const uint32_t node : merging.representative)
    grains.representative.push_back(graph.nodes[node].position);
  return grains;
}

GrainLabels labelGrains(const Int32Grid& manifold, const LeafIndex& index,
                        const ManifoldGraph& graph, const Merging& merging,
                        Interrupter* interrupter) {
  GrainLabels grains = grainsOf(graph, merging);
  grains.label = VoxelArray<uint32_t>(size_t(index.voxelCount()));
  std::vector<int64_t> voxels(graph.nodes.size(), 0);  // by manifold
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const auto tree = manifold.getConstAccessor();
    int32_t last = 1;  // neighbors mostly share their manifold: count by runs
    int64_t run = 0;
    const auto flush = [&] {
      if (run > 0) __atomic_fetch_add(&voxels[size_t(last - 1)], run, __ATOMIC_RELAXED);
    };
    for (size_t i = begin; i < end; ++i) {
      const Int32Tree::LeafNodeType* leaf = tree.probeConstLeaf(index.origin(i));
      const int32_t tile = leaf ? 0 : tree.getValue(index.origin(i));
      forEachVoxel(index, i, i + 1, [&](VoxelId id, size_t rank) {
        const int32_t number = leaf ? leaf->getValue(offsetOf(id)) : tile;
        if (number < 1 || size_t(number) > merging.grainOfNode.size())
          throw InvalidInput("grid '" + manifold.getName() + "' has a manifold number " +
                             std::to_string(number) + " that its graph does not know");
        if (number != last) {
          flush();
          last = number;
          run = 0;
        }
        ++run;
        grains.label[rank] = uint32_t(merging.grainOfNode[size_t(number - 1)]);
      });
    }
    flush();
  });
  for (size_t i = 0; i < voxels.size(); ++i)
    if (voxels[i] != graph.nodes[i].voxels)
      throw InvalidInput("grid '" + manifold.getName() + "' has " + std::to_string(voxels[i]) +
                         " voxels of manifold " + std::to_string(i + 1) + ", and its graph says " +
                         std::to_string(graph.nodes[i].voxels) + ": segment again");
  return grains;
}

}  // namespace vdb_madf::detail
