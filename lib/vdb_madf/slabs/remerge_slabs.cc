// SPDX-FileCopyrightText: The vdb_madf authors
// SPDX-License-Identifier: Apache-2.0

#include "vdb_madf/slabs/remerge_slabs.h"

#include <utility>

#include "vdb_madf/segmentation/graph_metadata.h"
#include "vdb_madf/segmentation/segmentation_metadata.h"
#include "vdb_madf/slabs/steps/slab_options.h"
#include "vdb_madf/slabs/steps/slab_remerge.h"

namespace vdb_madf {

namespace {

/// Says of labels what \p manifolds says, brought up to date.
void describe(const Int32Grid& manifolds, const SegmentOptions& options, int64_t grains,
              Int32Grid& grain) {
  for (auto meta = manifolds.beginMeta(); meta != manifolds.endMeta(); ++meta)
    if (meta->first != openvdb::GridBase::META_GRID_NAME)
      grain.insertMeta(meta->first, *meta->second);
  grain.setTransform(manifolds.transform().copy());
  removeGraph(grain);
  describeMerging(grain, options.merge, options.tidy, grains);
}

}  // namespace

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
        describe(*manifolds.about, how, result.counts.grains, *grain);
        put(slab, grain);
      });
  return std::move(result.grainVoxels);
}

}  // namespace vdb_madf
