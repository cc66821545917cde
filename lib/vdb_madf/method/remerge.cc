// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/method/remerge.h"

#include "vdb_madf/base/errors.h"
#include "vdb_madf/leaves/leaf_grid.h"
#include "vdb_madf/method/detail/manifold_labels.h"
#include "vdb_madf/method/graph_metadata.h"
#include "vdb_madf/method/segmentation_metadata.h"

namespace vdb_madf {

Int32Grid::Ptr remerge(const Int32Grid& manifold, const MergeOptions& options, int tidyRounds,
                       Interrupter* interrupter) {
  checkMergeOptions(options);
  checkTidy(tidyRounds);
  const std::optional<ManifoldGraph> graph = vdb_madf::storedGraph(manifold);
  if (!graph)
    throw InvalidInput(
        "grid '" + manifold.getName() + "' carries no graph of manifolds: segment again",
        Hint::manifolds);
  const Merging merging = merge(*graph, options);

  const LeafIndex index = detail::topologyOf(manifold);
  GrainLabels grains = detail::labelGrains(manifold, index, *graph, merging, interrupter);
  tidy(index, tidyRounds, grains, interrupter);
  const Int32Grid::Ptr grain = toGrid(index, std::move(grains.label), "grain", interrupter);
  for (auto meta = manifold.beginMeta(); meta != manifold.endMeta(); ++meta)
    if (meta->first != openvdb::GridBase::META_GRID_NAME)
      grain->insertMeta(meta->first, *meta->second);
  grain->setTransform(manifold.transform().copy());
  removeGraph(*grain);
  describeMerging(*grain, options, tidyRounds, int64_t(merging.representative.size()));
  return grain;
}

}  // namespace vdb_madf
