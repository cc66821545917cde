// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/detail/manifold_labels.h"

#include <string>

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
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const auto tree = manifold.getConstAccessor();
    for (size_t i = begin; i < end; ++i) {
      const Int32Tree::LeafNodeType* leaf = tree.probeConstLeaf(index.origin(i));
      const int32_t tile = leaf ? 0 : tree.getValue(index.origin(i));
      forEachVoxel(index, i, i + 1, [&](VoxelId id, size_t rank) {
        const int32_t number = leaf ? leaf->getValue(offsetOf(id)) : tile;
        if (number < 1 || size_t(number) > merging.grainOfNode.size())
          throw InvalidInput("grid '" + manifold.getName() + "' has a manifold number " +
                             std::to_string(number) + " that its graph does not know");
        const int32_t grain = merging.grainOfNode[size_t(number - 1)];
        if (grain < 1)
          throw InvalidInput("grid '" + manifold.getName() + "' has voxels of manifold " +
                             std::to_string(number) + ", and its graph says there are none");
        grains.label[rank] = uint32_t(grain);
      });
    }
  });
  return grains;
}

}  // namespace vdb_madf::detail
