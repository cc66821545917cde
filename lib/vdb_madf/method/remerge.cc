// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/remerge.h"

#include <openvdb/tree/LeafManager.h>

#include "vdb_madf/base/detail/parallel.h"
#include "vdb_madf/base/errors.h"
#include "vdb_madf/method/graph_metadata.h"
#include "vdb_madf/method/segmentation_metadata.h"

namespace vdb_madf {

namespace {

constexpr size_t kLeafGrain = 64;

}  // namespace

Int32Grid::Ptr remerge(const Int32Grid& manifold, const MergeOptions& options,
                       Interrupter* interrupter) {
  checkMergeOptions(options);
  const std::optional<ManifoldGraph> graph = vdb_madf::storedGraph(manifold);
  if (!graph)
    throw InvalidInput(
        "grid '" + manifold.getName() + "' carries no graph of manifolds: segment again",
        Hint::manifolds);
  const Merging merging = merge(*graph, options);

  auto grain = manifold.deepCopy();
  grain->setName("grain");
  removeGraph(*grain);
  grain->tree().voxelizeActiveTiles();
  openvdb::tree::LeafManager<Int32Tree> leaves(grain->tree());
  detail::parallelFor(leaves.leafCount(), kLeafGrain, interrupter, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (auto voxel = leaves.leaf(i).beginValueOn(); voxel; ++voxel) {
        const int32_t number = *voxel;
        if (number < 1 || size_t(number) > merging.grainOfNode.size())
          throw InvalidInput("grid '" + manifold.getName() + "' has a manifold number " +
                             std::to_string(number) + " that its graph does not know");
        voxel.setValue(merging.grainOfNode[size_t(number - 1)]);
      }
    }
  });
  describeMerging(*grain, options, int64_t(merging.representative.size()));
  return grain;
}

}  // namespace vdb_madf
