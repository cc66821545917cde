// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/segmentation/detail/manifold_labels.h"

#include <algorithm>
#include <numeric>
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

VoxelArray<uint32_t> nodesOf(const Int32Grid& manifold, const LeafIndex& index,
                             const ManifoldGraph& graph, const std::vector<uint32_t>& numbers,
                             Interrupter* interrupter) {
  VoxelArray<uint32_t> nodes(size_t(index.voxelCount()));
  std::vector<int64_t> voxels(graph.nodes.size(), 0);
  const auto nodeOf = [&](int32_t number) {
    const auto found = std::lower_bound(numbers.begin(), numbers.end(), int64_t(number));
    if (found == numbers.end() || int64_t(*found) != number)
      throw InvalidInput("grid '" + manifold.getName() + "' has a manifold number " +
                         std::to_string(number) + " that its graph does not know");
    return uint32_t(found - numbers.begin());
  };
  parallelFor(index.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    const auto tree = manifold.getConstUnsafeAccessor();
    int32_t last = 0;  // neighbors mostly share their manifold: count by runs
    uint32_t node = 0;
    int64_t run = 0;
    const auto flush = [&] {
      if (run > 0) __atomic_fetch_add(&voxels[node], run, __ATOMIC_RELAXED);
    };
    for (size_t i = begin; i < end; ++i) {
      const Int32Tree::LeafNodeType* leaf = tree.probeConstLeaf(index.origin(i));
      const int32_t tile = leaf ? 0 : tree.getValue(index.origin(i));
      forEachVoxel(index, i, i + 1, [&](VoxelId id, size_t rank) {
        const int32_t number = leaf ? leaf->getValue(offsetOf(id)) : tile;
        if (number != last || run == 0) {
          flush();
          node = nodeOf(number);
          last = number;
          run = 0;
        }
        ++run;
        nodes[rank] = node;
      });
    }
    flush();
  });
  for (size_t i = 0; i < voxels.size(); ++i)
    if (voxels[i] != graph.nodes[i].voxels)
      throw InvalidInput("grid '" + manifold.getName() + "' has " + std::to_string(voxels[i]) +
                         " voxels of manifold " + std::to_string(numbers[i]) +
                         ", and its graph says " + std::to_string(graph.nodes[i].voxels) +
                         ": segment again");
  return nodes;
}

GrainLabels labelGrains(const Int32Grid& manifold, const LeafIndex& index,
                        const ManifoldGraph& graph, const Merging& merging,
                        Interrupter* interrupter) {
  std::vector<uint32_t> numbers(graph.nodes.size());
  std::iota(numbers.begin(), numbers.end(), 1);
  GrainLabels grains = grainsOf(graph, merging);
  grains.label = nodesOf(manifold, index, graph, numbers, interrupter);
  constexpr size_t kVoxelGrain = size_t(1) << 16;
  parallelForEach(grains.label.size(), kVoxelGrain, interrupter, [&](size_t i) {
    grains.label[i] = uint32_t(merging.grainOfNode[grains.label[i]]);
  });
  return grains;
}

}  // namespace vdb_madf::detail
