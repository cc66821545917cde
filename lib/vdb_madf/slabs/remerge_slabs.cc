// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/remerge_slabs.h"

#include <utility>

#include "vdb_madf/grids/grid_metadata.h"
#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/slabs/steps/slab_options.h"
#include "vdb_madf/slabs/steps/slab_remerge.h"

namespace vdb_madf {

std::vector<int64_t> remergeSlabs(const LabelSlabs& manifolds, const MergeOptions& options,
                                  int tidyRounds, Scratch& scratch, const PutGrain& put,
                                  Interrupter* interrupter) {
  SegmentOptions how;
  how.merge = options;
  how.tidy = tidyRounds;
  const SlabObject object = detail::manifoldObject(manifolds, scratch);
  detail::checkSlabOptions(object, how);
  if (object.slabCount() == 0) return {};
  Team alone;
  detail::SlabWork work(object, how, scratch, alone, interrupter);
  detail::SlabRemerge remerge(manifolds, work);
  remerge.read();
  SlabSegmentation result;
  remerge.merge(
      result, [&](size_t slab, const detail::SlabBody& body, VoxelArray<uint32_t> labels) {
        const Int32Grid::Ptr grain = detail::slabGrid(work, slab, body, std::move(labels), "grain");
        copyMetadata(*manifolds.about, *grain);
        removeGraph(*grain);
        describeMerging(*grain, options, tidyRounds, result.counts.grains);
        put(slab, grain);
      });
  return std::move(result.grainVoxels);
}

}  // namespace vdb_madf
